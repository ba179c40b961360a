//! A matching that costs little more than the cheapest, with a proof: an auction.
//!
//! Bertsekas (1988), "The auction algorithm: a distributed relaxation method for the assignment problem", in the form that
//! Kerber, Morozov & Nigmetov (2017), "Geometry helps to compare persistence diagrams", give it for diagrams. Points of one
//! diagram bid for points of the other and for a place of their own on the diagonal; for each point of the other a place on
//! the diagonal bids for it and for all those other places, between which nothing costs. The best item goes to the bidder at
//! a price raised by how much worse the second best is, and ε more. Prices are kept while ε falls from phase to phase.
//!
//! For any prices, the sum over bidders of their best offers less the sum of prices is no more than what the cheapest
//! matching costs. When that is near enough to what the present one costs, the auction ends.

use super::ground::Point;
use super::kd_tree::{KdTree, Offer};
use crate::pairing::NONE;
use crate::watch::Watch;

/// By how much ε falls from phase to phase, as Kerber, Morozov & Nigmetov have it.
const FALL: f64 = 5.0;

/// By how much the first ε is more than what a bidder pays on average where all get what they like best: 30 takes half the time
/// of 4 for 1,000 and 3,000 points, uniform, near the diagonal and far from it. Measured by the largest cost instead, ε would
/// be lost in the rounding of prices where diagrams are nearly the same.
const FIRST: f64 = 30.0;

/// At this part of the largest cost at least ε begins.
const FLOOR: f64 = 1e-14;

/// At this part of the highest price ε ends: rounding has its say beyond.
const LEAST: f64 = 1e-11;

/// How many bids a phase may take for each bidder until ε is found too small, and by how much it is raised then. Diagrams
/// with many equal points, not as many in both, promise to cost nothing and have to bid up to the diagonal.
const BIDS: usize = 200;
const RISE: f64 = 100.0;

/// How many phases there may be.
const PHASES: usize = 80;

/// What it costs to go by some steps along both axes, and to the diagonal.
pub(super) trait Scale {
    fn cost(&self, along_births: f64, along_deaths: f64) -> f64;
    fn alone(&self, point: Point) -> f64;
}

/// For each point of `a` its partner in `b`, or [`NONE`] for the diagonal, where what the matching costs and what the cheapest
/// costs at least are `near` enough; `None` if that is beyond rounding, or the watch has stopped the work.
pub(super) fn bid(
    a: &[Point],
    b: &[Point],
    scale: &impl Scale,
    near: impl Fn(f64, f64) -> bool,
    watch: Watch<'_>,
) -> Option<Vec<u32>> {
    let mut auction = Auction::new(a, b, scale);
    let largest = auction.alone.iter().chain(&auction.others).copied().fold(0.0, f64::max);
    let mut epsilon = (FIRST * auction.bound() / auction.item_of.len() as f64).max(FLOOR * largest);
    for _ in 0..PHASES {
        if epsilon <= LEAST * auction.highest || watch.stops() {
            break;
        }
        if !auction.phase(epsilon, watch) {
            epsilon *= RISE;
            continue;
        }
        let cost = auction.cost();
        if cost == 0.0 || near(cost, auction.bound()) {
            return Some(auction.partners());
        }
        epsilon /= FALL;
    }
    None
}

/// Bidders are the points of `a` and then a place for each point of `b`. Items are the points of `b` and then a place for each
/// point of `a`.
struct Auction<'a, C> {
    a: &'a [Point],
    b: &'a [Point],
    scale: &'a C,
    /// What each point of `a`, and each of `b`, costs at the diagonal.
    alone: Vec<f64>,
    others: Vec<f64>,
    tree: KdTree,
    places: Places,
    /// The highest price so far.
    highest: f64,
    /// For each bidder its item, for each item its bidder.
    item_of: Vec<u32>,
    bidder_of: Vec<u32>,
}

impl<'a, C: Scale> Auction<'a, C> {
    fn new(a: &'a [Point], b: &'a [Point], scale: &'a C) -> Self {
        let costs = |points: &[Point]| points.iter().map(|&point| scale.alone(point)).collect();
        let count = a.len() + b.len();
        Self {
            a,
            b,
            scale,
            alone: costs(a),
            others: costs(b),
            tree: KdTree::new(b),
            places: Places::new(a.len()),
            highest: 0.0,
            item_of: vec![NONE; count],
            bidder_of: vec![NONE; count],
        }
    }

    /// Sells all items anew, at the present prices and above. False if ε is too small: if that takes too many bids, or it is
    /// lost in the rounding of a price; or if the watch has stopped the work.
    fn phase(&mut self, epsilon: f64, watch: Watch<'_>) -> bool {
        self.item_of.fill(NONE);
        self.bidder_of.fill(NONE);
        let mut waiting: Vec<u32> = (0..self.item_of.len() as u32).rev().collect();
        let mut bids = BIDS * self.item_of.len();
        while let Some(bidder) = waiting.pop() {
            let Offer { item, best, second } = self.offer(bidder as usize);
            let item = item.expect("all bidders have a place on the diagonal or a point to bid for");
            // With nothing else to choose the price does not matter.
            let step = if second.is_finite() { second - best } else { 0.0 };
            let (before, price) = (self.price(item), self.price(item) + step + epsilon);
            bids = bids.saturating_sub(1);
            if bids == 0 || epsilon == 0.0 || price - before < epsilon / 2.0 || watch.stops() {
                return false;
            }
            self.highest = self.highest.max(price);
            self.raise(item, price);
            let ousted = core::mem::replace(&mut self.bidder_of[item as usize], bidder);
            self.item_of[bidder as usize] = item;
            if ousted != NONE {
                self.item_of[ousted as usize] = NONE;
                waiting.push(ousted);
            }
        }
        true
    }

    /// What is best and second best for a bidder at the present prices.
    fn offer(&self, bidder: usize) -> Offer {
        let mut offer = Offer::NONE;
        if let Some(&point) = self.a.get(bidder) {
            let place = (self.b.len() + bidder) as u32;
            offer.consider(place, self.alone[bidder] + self.price(place));
            self.tree.offer(point, &|x, y| self.scale.cost(x, y), &mut offer);
        } else {
            let point = bidder - self.a.len();
            offer.consider(point as u32, self.others[point] + self.tree.price(point as u32));
            for (place, price) in self.places.cheapest_two().into_iter().flatten() {
                offer.consider((self.b.len() + place) as u32, price);
            }
        }
        offer
    }

    fn price(&self, item: u32) -> f64 {
        match (item as usize).checked_sub(self.b.len()) {
            Some(place) => self.places.price(place),
            None => self.tree.price(item),
        }
    }

    fn raise(&mut self, item: u32, price: f64) {
        match (item as usize).checked_sub(self.b.len()) {
            Some(place) => self.places.raise(place, price),
            None => self.tree.raise(item, price),
        }
    }

    /// What the present matching costs.
    fn cost(&self) -> f64 {
        let of_bidder = |(bidder, &item): (usize, &u32)| match (self.a.get(bidder), self.b.get(item as usize)) {
            (Some(p), Some(q)) => self.scale.cost((p.0 - q.0).abs(), (p.1 - q.1).abs()),
            (Some(_), None) => self.alone[bidder],
            (None, Some(_)) => self.others[item as usize],
            (None, None) => 0.0,
        };
        self.item_of.iter().enumerate().map(of_bidder).sum()
    }

    /// What every matching costs at least.
    fn bound(&self) -> f64 {
        let offers: f64 = (0..self.item_of.len()).map(|bidder| self.offer(bidder).best).sum();
        let prices: f64 = (0..self.item_of.len() as u32).map(|item| self.price(item)).sum();
        offers - prices
    }

    fn partners(&self) -> Vec<u32> {
        let partner = |&item: &u32| if (item as usize) < self.b.len() { item } else { NONE };
        self.item_of[..self.a.len()].iter().map(partner).collect()
    }
}

/// Prices of the places on the diagonal, the cheapest at hand: a tournament tree.
struct Places {
    count: usize,
    /// The prices begin at `count`; before them each has the lower of its two children.
    prices: Vec<f64>,
}

impl Places {
    fn new(count: usize) -> Self {
        Self { count, prices: vec![0.0; 2 * count] }
    }

    fn price(&self, place: usize) -> f64 {
        self.prices[self.count + place]
    }

    fn raise(&mut self, place: usize, price: f64) {
        let mut at = self.count + place;
        self.prices[at] = price;
        while at > 1 {
            at /= 2;
            let least = self.prices[2 * at].min(self.prices[2 * at + 1]);
            if least == self.prices[at] {
                return;
            }
            self.prices[at] = least;
        }
    }

    /// The two places of the lowest prices.
    fn cheapest_two(&self) -> [Option<(usize, f64)>; 2] {
        if self.count == 0 {
            return [None, None];
        }
        let first = self.cheapest_below(1);
        // The second is the cheapest of what the first has beaten on its way up.
        let (mut at, mut second): (usize, Option<usize>) = (first, None);
        while at > 1 {
            let rival = at ^ 1;
            if second.is_none_or(|second| self.prices[rival] < self.prices[second]) {
                second = Some(rival);
            }
            at /= 2;
        }
        let place = |at: usize| (at - self.count, self.prices[at]);
        [Some(place(first)), second.map(|rival| place(self.cheapest_below(rival)))]
    }

    /// Where the lowest price below a node stands.
    fn cheapest_below(&self, mut at: usize) -> usize {
        while at < self.count {
            at = if self.prices[2 * at] <= self.prices[2 * at + 1] { 2 * at } else { 2 * at + 1 };
        }
        at
    }
}

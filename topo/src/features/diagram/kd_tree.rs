//! The cheapest and second cheapest point for a bidder, by distance and price together.
//!
//! A k-d tree (Bentley 1975) of points in the plane that are for sale; every node has the box of its points and their lowest
//! price, so that what can be no cheaper than the second best is passed over (Kerber, Morozov & Nigmetov 2017, §4).

use super::ground::{Ground, Point};

/// Points in a leaf: a few, so that their boxes are worth a look.
const LEAF: usize = 8;

const ROOT: usize = 0;

/// What something costs, least first, and where; what the second cheapest costs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Offer {
    pub(super) item: Option<u32>,
    pub(super) best: f64,
    pub(super) second: f64,
}

impl Offer {
    /// Nothing to buy.
    pub(super) const NONE: Self = Self { item: None, best: f64::INFINITY, second: f64::INFINITY };

    /// Takes something else into account.
    #[inline]
    pub(super) fn consider(&mut self, item: u32, total: f64) {
        if total < self.best {
            *self = Self { item: Some(item), best: total, second: self.best };
        } else if total < self.second {
            self.second = total;
        }
    }
}

struct Node {
    low: Point,
    high: Point,
    least_price: f64,
    parent: u32,
    /// Two children, one after the other, or none: then the node is a leaf.
    children: Option<u32>,
    /// The places of its points.
    range: [u32; 2],
}

/// Points by place in the tree, with prices.
pub(super) struct KdTree {
    nodes: Vec<Node>,
    points: Vec<Point>,
    prices: Vec<f64>,
    /// For each place the item that stands there, the place of each item, and the leaf of each place.
    items: Vec<u32>,
    places: Vec<u32>,
    leaves: Vec<u32>,
}

impl KdTree {
    /// A tree of some points with a price for each.
    pub(super) fn new(points: &[Point]) -> Self {
        let count = points.len();
        let mut items: Vec<u32> = (0..count as u32).collect();
        let (mut nodes, mut leaves) = (Vec::new(), vec![0; count]);
        let root = Node {
            low: (0.0, 0.0),
            high: (0.0, 0.0),
            least_price: 0.0,
            parent: 0,
            children: None,
            range: [0, count as u32],
        };
        nodes.push(root);
        let mut next = ROOT;
        while next < nodes.len() {
            split(&mut nodes, next, points, &mut items, &mut leaves);
            next += 1;
        }
        let mut places = vec![0; count];
        (0..).zip(&items).for_each(|(place, &item)| places[item as usize] = place);
        let points = items.iter().map(|&item| points[item as usize]).collect();
        Self { nodes, points, prices: vec![0.0; count], items, places, leaves }
    }

    /// The price of an item.
    pub(super) fn price(&self, item: u32) -> f64 {
        self.prices[self.places[item as usize] as usize]
    }

    /// Raises the price of an item.
    pub(super) fn raise(&mut self, item: u32, price: f64) {
        let place = self.places[item as usize] as usize;
        self.prices[place] = price;
        let mut at = self.leaves[place] as usize;
        loop {
            let node = &self.nodes[at];
            let least = match node.children {
                Some(first) => {
                    let [a, b] = [first as usize, first as usize + 1].map(|child| self.nodes[child].least_price);
                    a.min(b)
                }
                None => least_of(&self.prices[node.range[0] as usize..node.range[1] as usize]),
            };
            let parent = node.parent as usize;
            if least == node.least_price {
                return;
            }
            self.nodes[at].least_price = least;
            if at == ROOT {
                return;
            }
            at = parent;
        }
    }

    /// Finds an item within reach of a place that has not been taken, and takes it: its price is then infinite.
    pub(super) fn take(&mut self, from: Point, ground: Ground, reach: f64) -> Option<u32> {
        let item = if self.items.is_empty() { None } else { self.within(ROOT, from, ground, reach) }?;
        self.raise(item, f64::INFINITY);
        Some(item)
    }

    /// Puts all items back, for nothing.
    pub(super) fn offer_all(&mut self) {
        self.prices.fill(0.0);
        self.nodes.iter_mut().for_each(|node| node.least_price = 0.0);
    }

    fn within(&self, at: usize, from: Point, ground: Ground, reach: f64) -> Option<u32> {
        let node = &self.nodes[at];
        if node.least_price == f64::INFINITY {
            return None;
        }
        // Of all norms the largest is no longer, and is not rounded.
        let [x, y] = node.gaps(from);
        if x.max(y) > reach {
            return None;
        }
        if let Some(first) = node.children {
            let children = [first as usize, first as usize + 1];
            return children.into_iter().find_map(|child| self.within(child, from, ground, reach));
        }
        let place = (node.range[0] as usize..node.range[1] as usize)
            .find(|&place| self.prices[place] < f64::INFINITY && ground.distance(self.points[place], from) <= reach)?;
        Some(self.items[place])
    }

    /// Adds what all points offer to someone at a place, where going by some steps along both axes costs what `cost` says.
    pub(super) fn offer(&self, from: Point, cost: &impl Fn(f64, f64) -> f64, offer: &mut Offer) {
        if !self.items.is_empty() {
            self.offer_below(ROOT, from, cost, offer);
        }
    }

    fn offer_below(&self, at: usize, from: Point, cost: &impl Fn(f64, f64) -> f64, offer: &mut Offer) {
        let node = &self.nodes[at];
        if let Some(first) = node.children {
            let children = [first as usize, first as usize + 1];
            let [a, b] = children.map(|child| self.least(child, from, cost));
            let order = if b < a { [(children[1], b), (children[0], a)] } else { [(children[0], a), (children[1], b)] };
            for (child, least) in order {
                if least < offer.second {
                    self.offer_below(child, from, cost, offer);
                }
            }
        } else {
            for place in node.range[0] as usize..node.range[1] as usize {
                let point = self.points[place];
                let total = cost((point.0 - from.0).abs(), (point.1 - from.1).abs()) + self.prices[place];
                offer.consider(self.items[place], total);
            }
        }
    }

    /// What the points of a node cost at least.
    fn least(&self, node: usize, from: Point, cost: &impl Fn(f64, f64) -> f64) -> f64 {
        let node = &self.nodes[node];
        let [x, y] = node.gaps(from);
        cost(x, y) + node.least_price
    }
}

impl Node {
    /// How far its box is from a place along both axes.
    fn gaps(&self, from: Point) -> [f64; 2] {
        let gap = |at: f64, low: f64, high: f64| (low - at).max(at - high).max(0.0);
        [gap(from.0, self.low.0, self.high.0), gap(from.1, self.low.1, self.high.1)]
    }
}

fn least_of(prices: &[f64]) -> f64 {
    prices.iter().copied().fold(f64::INFINITY, f64::min)
}

/// Finds the box of a node and, if it has many points, splits it at the median of its longer side.
fn split(nodes: &mut Vec<Node>, at: usize, points: &[Point], items: &mut [u32], leaves: &mut [u32]) {
    let [start, end] = nodes[at].range.map(|place| place as usize);
    let inside = &mut items[start..end];
    let (mut low, mut high) = ((f64::INFINITY, f64::INFINITY), (f64::NEG_INFINITY, f64::NEG_INFINITY));
    for &item in inside.iter() {
        let point = points[item as usize];
        low = (low.0.min(point.0), low.1.min(point.1));
        high = (high.0.max(point.0), high.1.max(point.1));
    }
    (nodes[at].low, nodes[at].high) = (low, high);
    if inside.len() <= LEAF {
        leaves[start..end].fill(at as u32);
        return;
    }
    let is_wide = high.0 - low.0 >= high.1 - low.1;
    let coordinate = |item: &u32| if is_wide { points[*item as usize].0 } else { points[*item as usize].1 };
    let middle = inside.len() / 2;
    inside.select_nth_unstable_by(middle, |p, q| coordinate(p).total_cmp(&coordinate(q)).then(p.cmp(q)));
    nodes[at].children = Some(nodes.len() as u32);
    for range in [[start, start + middle], [start + middle, end]] {
        nodes.push(Node {
            low,
            high,
            least_price: 0.0,
            parent: at as u32,
            children: None,
            range: range.map(|place| place as u32),
        });
    }
}

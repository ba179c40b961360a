//! Cuts that let islands fill a square better.
//!
//! A long bent island fills little of any square. Cut across where it is narrow, its pieces fill more. All short paths
//! across the largest islands are compared by the rectangles about what they leave on either side ([`across`](super::across));
//! the most promising are packed, roughly, and the one or two that gain most are cut, as long as they gain enough and
//! the seam that may be added lasts. Nothing moves: whoever packs finds more islands.

use geom::{EdgeData, EdgeId, FaceId, Interrupted, Mesh, Watch};
use rayon::prelude::*;

use super::across::{Across, Paths, Side, Sweep};
use super::map::UvMap;
use super::pack::{PackOptions, Piece, Rough};

/// So many cuts are made at most: a wire has 9 % of the square with 6, 48 % with 11, a spring 34 and 66 %; of 25 scans and parts none is cut so often.
const MOST_CUTS: usize = 16;
/// So many of the largest islands may be cut, of those with at least this share of all area.
const LARGEST: usize = 3;
const LEAST_ISLAND: f64 = 0.1;
/// Either side of a cut keeps at least this share of its island.
const LEAST_SHARE: f64 = 0.04;
/// So many paths are packed, half of them with the smallest rectangles, half with the smallest for their length.
const TRIED: usize = 24;
/// Of those of all islands so many are compared by more than one packing, the best by that one.
const COMPARED: usize = 16;
/// Of those that pass within this share of the island's extent of a better one, none is tried.
const NEAR: f64 = 0.06;
/// A cut must raise the fill by so much, or by this share of it where there is little, and by so much more if it takes all of the seam that is left.
const LEAST_GAIN: f64 = 0.012;
const LEAST_GROWTH: f64 = 0.2;
const PRICE: f64 = 0.03;
/// After so many of the best a second one is sought, on models of at most so many triangles: two are made at once if they gain more by
/// [`LEAST_GAIN`] than one, which may gain nothing alone. (15 surfaces with 32 cones: fill .590 with one at a time, .605 with two only where none
/// gains enough, .638 so, .643 with 24 first ones in twice the time.)
const FIRST: usize = 8;
const MOST_TRIANGLES: usize = 200_000;
/// On larger models, where no cut gains enough alone, two across different islands are: so many of each kind of the paths across each are tried with those across
/// others, and so many of these twos compared. (A map of the dragon, two islands that bound the square: fill .448, and no cut across one of them gains anything.)
const IN_TWOS: usize = 3;
const TWOS_COMPARED: usize = 8;
/// Of more islands than this fewer of the best are taken: raptor with 16 cones, where 16 are compared, takes 58 s otherwise.
const FEW_ISLANDS: usize = 5;
/// So many islands are packed for comparing, the largest.
const MOST_ISLANDS: usize = 16;
/// Where the others have more than this share of the area, or so much is filled, cuts gain too little for what they cost: bones, 26
/// islands that fill .75, took 5 s for nothing. On the dragon, 407 islands of which six have all but a thousandth, two cuts raise the fill
/// from .517 to .615 for 2.8 % of seam.
const MOST_BESIDE: f64 = 0.05;
const ENOUGH: f64 = 0.72;
/// The smallest with this share of the area together find room anywhere: of the 71 islands of a bunny's 67 parts five are compared.
const DUST: f64 = 1e-3;

/// A map of a part of a model, with the lengths of its edges in space: infinite where nothing may be cut.
#[derive(Clone, Copy, Debug)]
pub struct Part<'a> {
    /// The surface.
    pub mesh: &'a Mesh,
    /// In one unit for all parts.
    pub lengths: &'a EdgeData<f64>,
    /// Where its triangles lie, in one unit for all parts.
    pub map: &'a UvMap,
}

/// A cut that could be made.
struct Trial<'a> {
    part: usize,
    island: usize,
    /// Its place among the [promising] ones: a half of them by their rectangles, then those by their length as well.
    rank: usize,
    sweep: &'a Sweep,
    across: Across,
}

impl Trial<'_> {
    fn cut(&self, paths: &[Paths], gain: f64) -> Cut {
        Cut { gain, part: self.part, edges: paths[self.part].edges(&self.across), length: self.across.length }
    }
}

/// A cut: what it raises the fill by, beyond what its length costs, and where it is.
#[derive(Clone)]
struct Cut {
    gain: f64,
    part: usize,
    edges: Vec<EdgeId>,
    length: f64,
}

/// What was found in one sweep.
#[derive(Default)]
struct Found {
    /// The cuts that were packed, the one that gains most first; none where it is not worth while.
    cuts: Vec<Cut>,
    /// Two across different islands, where none gains enough alone and these do; the first is said to gain what both do.
    two: Vec<Cut>,
    /// What cuts must gain.
    least: f64,
    /// How many islands were compared.
    islands: usize,
    /// The length of the shortest path that there was: infinite if there was none, 0 where none was looked for.
    shortest: f64,
}

/// The edges to open maps along so that their islands, packed together, fill more of a square: those that are open, and
/// paths across islands, up to `most` in length altogether. Islands stay disks; what is no disk is not cut.
///
/// Up to 72 paths packed once, 17 rough packings and a sweep over the largest islands for each cut, nine times that on smaller
/// models; on larger ones up to 108 twos packed once and 8 roughly where no cut gains enough alone.
///
/// # Errors
/// If it is stopped.
pub fn cut_for_fill(
    parts: &[Part],
    most: f64,
    options: &PackOptions,
    watch: Watch,
) -> Result<Vec<EdgeData<bool>>, Interrupted> {
    cut_from(parts, most, MOST_TRIANGLES, options, watch)
}

/// The same, large being a model of more than so many triangles.
fn cut_from(
    parts: &[Part],
    most: f64,
    most_triangles: usize,
    options: &PackOptions,
    watch: Watch,
) -> Result<Vec<EdgeData<bool>>, Interrupted> {
    let mut maps: Vec<UvMap> = parts.iter().map(|part| part.map.clone()).collect();
    let triangles: usize = parts.iter().map(|part| part.mesh.face_count()).sum();
    let (mut left, mut made) = (most, 0);
    while made < MOST_CUTS {
        let at = |cuts: usize| cuts as f64 / MOST_CUTS as f64;
        let watch = watch.within(at(made), at(made + 1));
        let is_large = triangles > most_triangles;
        let in_twos = is_large && made + 2 <= MOST_CUTS;
        let Found { cuts: found, two, least, islands, shortest } =
            cuts(parts, &maps, (left, in_twos), options, watch.within(0.0, 0.3))?;
        let mut chosen: Vec<Cut> = found.first().filter(|best| best.gain > least).cloned().into_iter().collect();
        if chosen.is_empty() {
            chosen = two;
        }
        if made + 2 <= MOST_CUTS && !is_large {
            let least = least + chosen.iter().map(|cut| cut.gain).sum::<f64>();
            let firsts = &found[..found.len().min(FIRST * FEW_ISLANDS / islands.max(FEW_ISLANDS))];
            let two = two_cuts(parts, &maps, firsts, (left, least), options, watch.within(0.3, 1.0))?;
            chosen = two.unwrap_or(chosen);
        }
        if chosen.is_empty() {
            break;
        }
        made += chosen.len();
        for cut in chosen {
            cut.edges.iter().for_each(|&e| maps[cut.part].cut[e] = true);
            left -= cut.length;
        }
        // On a large model it is not worth a sweep to see whether what was cut has shorter paths.
        if is_large && left < shortest {
            break;
        }
    }
    Ok(maps.into_iter().map(|map| map.cut).collect())
}

/// Two cuts, the first one of some, which together gain most and more than the least.
fn two_cuts(
    parts: &[Part],
    maps: &[UvMap],
    firsts: &[Cut],
    (left, least): (f64, f64),
    options: &PackOptions,
    watch: Watch,
) -> Result<Option<Vec<Cut>>, Interrupted> {
    let mut best: Option<Vec<Cut>> = None;
    let gain = |cuts: &[Cut]| cuts.iter().map(|cut| cut.gain).sum::<f64>();
    for (k, first) in firsts.iter().enumerate() {
        let mut maps = maps.to_vec();
        first.edges.iter().for_each(|&e| maps[first.part].cut[e] = true);
        let at = |k: usize| k as f64 / firsts.len() as f64;
        let then = cuts(parts, &maps, (left - first.length, false), options, watch.within(at(k), at(k + 1)))?;
        let two = then.cuts.into_iter().next().map(|second| vec![first.clone(), second]);
        best = two.filter(|two| gain(two) > best.as_deref().map_or(least, gain)).or(best);
    }
    Ok(best)
}

/// The cuts that could be made, in twos as well if that is asked for.
fn cuts(
    parts: &[Part],
    maps: &[UvMap],
    (left, in_twos): (f64, bool),
    options: &PackOptions,
    watch: Watch,
) -> Result<Found, Interrupted> {
    let found = watch.within(0.0, 0.2);
    let paths: Result<Vec<Paths>, Interrupted> =
        parts.iter().zip(maps).map(|(part, map)| Paths::new(part.mesh, part.lengths, map, found)).collect();
    let paths = paths?;
    watch.ask(0.2)?;
    // Each island's part and number in it, its triangles, and its outline.
    let mut islands = Vec::new();
    for (k, paths) in paths.iter().enumerate() {
        for (i, faces) in paths.islands().into_iter().enumerate() {
            let side = paths.outline(&faces);
            islands.push((k, i, faces, side));
        }
    }
    let whole: f64 = islands.iter().map(|(_, _, _, side)| side.area).sum();
    islands.sort_by(|a, b| b.3.area.total_cmp(&a.3.area).then((a.0, a.1).cmp(&(b.0, b.1))));
    let beside: f64 = islands.iter().skip(MOST_ISLANDS).map(|(_, _, _, side)| side.area).sum();
    if beside > MOST_BESIDE * whole {
        return Ok(Found { islands: islands.len(), ..Found::default() });
    }
    islands.truncate(MOST_ISLANDS);
    let mut rest = whole;
    let counts = islands.iter().take_while(|(_, _, _, side)| {
        let counts = rest >= DUST * whole;
        rest -= side.area;
        counts
    });
    islands.truncate(counts.count());
    let large = islands.iter().take(LARGEST).filter(|(_, _, _, side)| side.area > LEAST_ISLAND * whole).count();
    watch.ask(0.25)?;
    let sweep = |(k, _, faces, _): &(usize, usize, Vec<FaceId>, Side)| {
        watch.ask(0.3)?;
        Ok(paths[*k].sweep(faces))
    };
    let sweeps = islands[..large].iter().map(sweep).collect::<Result<Vec<Option<Sweep>>, Interrupted>>()?;
    let (mut trials, mut shortest) = (Vec::new(), f64::INFINITY);
    for (island, sweep) in sweeps.iter().enumerate() {
        let Some(sweep) = sweep else { continue };
        watch.ask(0.3)?;
        let part = islands[island].0;
        let extent = islands[island].3.area.sqrt();
        let across = paths[part].across(sweep, left, LEAST_SHARE, true);
        shortest = across.iter().fold(shortest, |least, path| least.min(path.length));
        watch.ask(0.3)?;
        let rectangles = paths[part].rectangles(sweep, &across, watch.within(0.3, 0.3))?;
        let across = promising(across.iter().zip(rectangles), extent, left);
        let ranked = across.into_iter().enumerate();
        trials.extend(ranked.map(|(rank, across)| Trial { part, island, rank, sweep, across }));
    }
    // Trials are packed at the same time: how far they are together nobody knows.
    let packing = watch.within(f64::NAN, f64::NAN);
    packing.ask(0.0)?;
    let outlines: Vec<&Side> = islands.iter().map(|(_, _, _, side)| side).collect();
    let rough = Rough::new(&outlines, options);
    let before = rough.fill(packing)?;
    if before > ENOUGH {
        return Ok(Found { islands: islands.len(), ..Found::default() });
    }
    let least = LEAST_GAIN.min(LEAST_GROWTH * before);
    let gain = |length: f64, fill: f64| fill - before - PRICE * length / left;
    let once = |trial: &Trial| {
        packing.ask(0.0)?;
        let sides = paths[trial.part].sides(trial.sweep, &trial.across).map(|side| rough.piece(&side));
        let fill = rough.fill_once_with(&[(trial.island, &sides)], packing)?;
        Ok((gain(trial.across.length, fill), sides))
    };
    let once = trials.par_iter().map(once).collect::<Result<Vec<(f64, [Piece; 2])>, Interrupted>>()?;
    let mut compared: Vec<(&Trial, &(f64, [Piece; 2]))> = trials.iter().zip(&once).collect();
    compared.sort_by(|(_, (a, _)), (_, (b, _))| b.total_cmp(a));
    compared.truncate(COMPARED);
    let fill = |(trial, (_, sides)): &(&Trial, &(f64, [Piece; 2]))| {
        packing.ask(0.0)?;
        Ok(gain(trial.across.length, rough.fill_with(&[(trial.island, sides)], packing)?))
    };
    let gains = compared.par_iter().map(fill).collect::<Result<Vec<f64>, Interrupted>>()?;
    let mut cuts: Vec<Cut> = compared.iter().zip(gains).map(|((trial, _), gain)| trial.cut(&paths, gain)).collect();
    cuts.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let mut found = Found { cuts, two: Vec::new(), least, islands: islands.len(), shortest };
    if in_twos && found.cuts.first().is_none_or(|best| best.gain <= least) {
        let sides: Vec<Tried> = trials.iter().zip(once.iter().map(|(_, sides)| sides)).collect();
        if let Some(([one, other], gain)) = best_two(&sides, (left, least), &rough, gain, packing)? {
            found.two = vec![one.cut(&paths, gain), other.cut(&paths, 0.0)];
        }
    }
    Ok(found)
}

/// A cut that could be made, and what it leaves of its island.
type Tried<'a> = (&'a Trial<'a>, &'a [Piece; 2]);

/// The two cuts across different islands that gain most, if that is enough.
fn best_two<'a>(
    trials: &[Tried<'a>],
    (left, least): (f64, f64),
    rough: &Rough,
    gain: impl Fn(f64, f64) -> f64 + Sync,
    packing: Watch,
) -> Result<Option<([&'a Trial<'a>; 2], f64)>, Interrupted> {
    let promising: Vec<Tried> =
        trials.iter().filter(|(trial, _)| trial.rank % (TRIED / 2) < IN_TWOS).copied().collect();
    let length = |two: &[Tried; 2]| two.iter().map(|(trial, _)| trial.across.length).sum::<f64>();
    let twos = promising.iter().enumerate().flat_map(|(k, one)| promising[k + 1..].iter().map(|other| [*one, *other]));
    let are_possible = |two: &[Tried; 2]| two[0].0.island != two[1].0.island && length(two) <= left;
    let twos: Vec<[Tried; 2]> = twos.filter(are_possible).collect();
    let instead = |two: &[Tried<'a>; 2]| two.map(|(trial, sides)| (trial.island, sides));
    let once = |two: &[Tried<'a>; 2]| {
        packing.ask(0.0)?;
        Ok(gain(length(two), rough.fill_once_with(&instead(two), packing)?))
    };
    let once = twos.par_iter().map(once).collect::<Result<Vec<f64>, Interrupted>>()?;
    let mut compared: Vec<([Tried; 2], f64)> = twos.into_iter().zip(once).collect();
    compared.sort_by(|(_, a), (_, b)| b.total_cmp(a));
    compared.truncate(TWOS_COMPARED);
    let fill = |(two, _): &([Tried<'a>; 2], f64)| {
        packing.ask(0.0)?;
        Ok(gain(length(two), rough.fill_with(&instead(two), packing)?))
    };
    let gains = compared.par_iter().map(fill).collect::<Result<Vec<f64>, Interrupted>>()?;
    let best = compared.into_iter().zip(gains).reduce(|best, next| if next.1 > best.1 { next } else { best });
    Ok(best.filter(|(_, gain)| *gain > least).map(|((two, _), gain)| (two.map(|(trial, _)| trial), gain)))
}

/// The paths that are worth packing, of some with their rectangles.
fn promising<'a>(across: impl Iterator<Item = (&'a Across, f64)>, extent: f64, left: f64) -> Vec<Across> {
    let mut across: Vec<(&Across, f64)> = across.collect();
    let mut chosen: Vec<Across> = Vec::new();
    for (is_by_length, count) in [(false, TRIED / 2), (true, TRIED)] {
        // Half a tenth of what is left beside the length, lest the shortest of all paths win; and a little of the length where it
        // does not count, since neighbouring paths often leave the same rectangles.
        let price =
            |path: &Across| if is_by_length { path.length + 0.05 * left } else { 1.0 + 1e-4 * path.length / left };
        let measure = |(path, rectangles): &(&Across, f64)| (rectangles - 1.0) / price(path);
        across.sort_by(|a, b| measure(a).total_cmp(&measure(b)));
        for (path, _) in &across {
            if chosen.len() < count && chosen.iter().all(|other| other.distance(path) > NEAR * extent) {
                chosen.push((*path).clone());
            }
        }
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::uv::{fill, pack};

    /// Three quarters of a ring, a grid of `n` by `m` squares, in the plane and in space.
    fn arc(n: u32, m: u32) -> (Mesh, EdgeData<f64>, UvMap) {
        strip([n, m], |along, across| {
            let (r, (sin, cos)) = (0.7 + 0.3 * across, (4.7 * along).sin_cos());
            [r * cos, r * sin]
        })
    }

    /// A strip of `n` by `m` squares that lies where its shares of the way along and across it are.
    fn strip([n, m]: [u32; 2], place: impl Fn(f64, f64) -> [f64; 2]) -> (Mesh, EdgeData<f64>, UvMap) {
        let vertex = |i: u32, j: u32| i * (m + 1) + j;
        let share = |k: u32, of: u32| f64::from(k) / f64::from(of);
        let at = |v: u32| place(share(v / (m + 1), n), share(v % (m + 1), m));
        let squares = (0..n).flat_map(|i| (0..m).map(move |j| (i, j)));
        let triangles: Vec<[u32; 3]> = squares
            .flat_map(|(i, j)| {
                let [a, b, c, d] = [vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1), vertex(i + 1, j)];
                [[a, b, c], [a, c, d]]
            })
            .collect();
        let mesh = Mesh::new(((n + 1) * (m + 1)) as usize, &triangles).unwrap();
        let position: geom::HalfedgeData<[f64; 2]> = mesh.halfedges().map(|h| at(mesh.tail(h).0)).collect();
        let length = |e: EdgeId| {
            let [p, q] = mesh.ends(e).map(|v| at(v.0));
            (p[0] - q[0]).hypot(p[1] - q[1])
        };
        let lengths = mesh.edges().map(length).collect();
        let map = UvMap::new(&mesh, position);
        (mesh, lengths, map)
    }

    fn packed(mesh: &Mesh, map: &UvMap, cut: &EdgeData<bool>) -> (usize, f64) {
        let islands = geom::Islands::new(mesh, cut);
        let island = islands.of_faces().to_vec();
        let packing = pack(map.triangles(), &island, &PackOptions::default(), Watch::NONE).unwrap();
        let placed = map
            .triangles()
            .iter()
            .zip(&island)
            .map(|(t, &i)| t.map(|p| packing.place(i as usize, p)))
            .collect::<Vec<_>>();
        assert!((fill(&placed) - packing.fill).abs() < 1e-9);
        (islands.count(), packing.fill)
    }

    #[test]
    fn a_bent_strip_is_cut_across_and_fills_more_within_what_may_be_added() {
        let (mesh, lengths, map) = arc(120, 8);
        let part = Part { mesh: &mesh, lengths: &lengths, map: &map };
        let none = cut_for_fill(&[part], 0.0, &PackOptions::default(), Watch::NONE).unwrap();
        assert_eq!(none, std::slice::from_ref(&map.cut));
        let (_, before) = packed(&mesh, &map, &none[0]);
        for most in [0.4, 0.8, 1.6] {
            let cut = &cut_for_fill(&[part], most, &PackOptions::default(), Watch::NONE).unwrap()[0];
            let added: f64 = mesh.edges().filter(|&e| cut[e]).map(|e| lengths[e]).sum();
            assert!(added <= most * (1.0 + 1e-12), "{added}");
            let (islands, after) = packed(&mesh, &map, cut);
            // Each cut is as long as the strip is wide, .3.
            assert_eq!(islands, 1 + (added / 0.3 + 0.5) as usize);
            assert!(after > before + 0.1, "{before} {after}");
        }
    }

    /// A cross of four arms, in squares of side 1: 2 wide, 8 long each.
    fn cross() -> (Mesh, EdgeData<f64>, UvMap) {
        let is_in = |i: u32, j: u32| (8..10).contains(&i) || (8..10).contains(&j);
        let squares = (0..18 * 18).map(|k| (k / 18, k % 18)).filter(|&(i, j)| is_in(i, j));
        let corners: Vec<[[u32; 2]; 3]> = squares
            .flat_map(|(i, j)| {
                let [a, b, c, d] = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
                [[a, b, c], [a, c, d]]
            })
            .collect();
        let mut points = corners.concat();
        points.sort_unstable();
        points.dedup();
        let number = |p: [u32; 2]| points.binary_search(&p).unwrap() as u32;
        let triangles: Vec<[u32; 3]> = corners.iter().map(|t| t.map(number)).collect();
        let mesh = Mesh::new(points.len(), &triangles).unwrap();
        let at = |v: geom::VertexId| points[v.0 as usize].map(f64::from);
        let position: geom::HalfedgeData<[f64; 2]> = mesh.halfedges().map(|h| at(mesh.tail(h))).collect();
        let length = |e: EdgeId| {
            let [p, q] = mesh.ends(e).map(at);
            (p[0] - q[0]).hypot(p[1] - q[1])
        };
        let lengths = mesh.edges().map(length).collect();
        let map = UvMap::new(&mesh, position);
        (mesh, lengths, map)
    }

    #[test]
    fn arms_of_a_cross_are_cut_off_two_at_a_time_where_that_fills_more() {
        let (mesh, lengths, map) = cross();
        let part = Part { mesh: &mesh, lengths: &lengths, map: &map };
        // An arm is 2 wide. One after the other they come to .60 and .67.
        for (most, least) in [(5.0, 0.65), (9.0, 0.8)] {
            let cut = &cut_for_fill(&[part], most, &PackOptions::default(), Watch::NONE).unwrap()[0];
            let (_, after) = packed(&mesh, &map, cut);
            assert!(after > least, "{after} with {most}");
        }
    }

    #[test]
    fn two_islands_that_bound_the_square_are_cut_at_the_same_time() {
        let bars = [1.0, 0.9].map(|width| strip([60, 2], |along, across| [30.0 * along, width * across]));
        let parts = bars.each_ref().map(|(mesh, lengths, map)| Part { mesh, lengths, map });
        let maps: Vec<UvMap> = parts.iter().map(|part| part.map.clone()).collect();
        let found =
            |left: f64, in_twos| cuts(&parts, &maps, (left, in_twos), &PackOptions::default(), Watch::NONE).unwrap();
        let Found { cuts: alone, two, shortest, .. } = found(4.0, true);
        assert!(alone[0].gain <= LEAST_GAIN && (shortest - 0.9).abs() < 1e-9, "{} {shortest}", alone[0].gain);
        assert!(two[0].gain > 0.1);
        let [one, other] = [&two[0], &two[1]];
        assert_eq!([one.part, other.part], [0, 1]);
        assert!((one.length - 1.0).abs() < 1e-9 && (other.length - 0.9).abs() < 1e-9);
        assert!(found(1.8, true).two.is_empty(), "they are longer together");
        assert!(found(4.0, false).two.is_empty(), "nobody asks");
        let cut = |most, most_triangles| {
            let cut = cut_from(&parts, most, most_triangles, &PackOptions::default(), Watch::NONE).unwrap();
            cut.iter().map(|cut| cut.iter().filter(|&&cut| cut).count()).collect::<Vec<_>>()
        };
        // Each bar is two squares wide.
        assert_eq!(cut(2.0, 1), [2, 2]);
        assert_eq!(cut(2.0, MOST_TRIANGLES), [2, 2]);
        assert_eq!(cut(1.8, 1), [0, 0]);
    }

    /// A tube of `n` rings of `m` squares, unrolled.
    fn tube(n: u32, m: u32) -> (Mesh, EdgeData<f64>, UvMap) {
        let vertex = |i: u32, j: u32| i * m + j % m;
        let squares = (0..n).flat_map(|i| (0..m).map(move |j| (i, j)));
        let corners: Vec<[[u32; 2]; 3]> = squares
            .flat_map(|(i, j)| {
                let [a, b, c, d] = [[i, j], [i, j + 1], [i + 1, j + 1], [i + 1, j]];
                [[a, b, c], [a, c, d]]
            })
            .collect();
        let triangles: Vec<[u32; 3]> = corners.iter().map(|t| t.map(|[i, j]| vertex(i, j))).collect();
        let mesh = Mesh::new(((n + 1) * m) as usize, &triangles).unwrap();
        let position: Vec<[f64; 2]> = corners.as_flattened().iter().map(|p| p.map(f64::from)).collect();
        let map = UvMap::new(&mesh, position.into());
        let length = |e: EdgeId| {
            let h = mesh.halfedge(e);
            let [p, q] = [h, mesh.next(h)].map(|h| map.position[h]);
            (p[0] - q[0]).hypot(p[1] - q[1])
        };
        let lengths = mesh.edges().map(length).collect();
        (mesh, lengths, map)
    }

    #[test]
    fn a_tube_is_cut_into_shorter_ones() {
        for (length, most, least) in [(200, 8.0, 1.8), (2000, 40.0, 3.0)] {
            let (mesh, lengths, map) = tube(length, 4);
            let part = Part { mesh: &mesh, lengths: &lengths, map: &map };
            let cut = &cut_for_fill(&[part], most, &PackOptions::default(), Watch::NONE).unwrap()[0];
            let [(_, before), (islands, after)] = [packed(&mesh, &map, &map.cut), packed(&mesh, &map, cut)];
            let added: f64 = mesh.edges().filter(|&e| cut[e] && !map.cut[e]).map(|e| lengths[e]).sum();
            // Round the tube it is four.
            assert!(islands > 1 && added <= 4.0 * (islands - 1) as f64 + 1e-9, "{added} for {islands} islands");
            assert!(after > least * before, "{before} {after}");
        }
    }

    #[test]
    fn edges_of_infinite_length_are_not_cut() {
        let (mesh, lengths, map) = arc(60, 4);
        let lengths: EdgeData<f64> = lengths.iter().map(|_| f64::INFINITY).collect();
        let part = Part { mesh: &mesh, lengths: &lengths, map: &map };
        let cut = cut_for_fill(&[part], 100.0, &PackOptions::default(), Watch::NONE).unwrap();
        assert_eq!(cut, std::slice::from_ref(&map.cut));
    }
}

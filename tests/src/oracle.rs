//! Slow and independent ways to the answers.

use std::cmp::Ordering;
use std::collections::{HashMap, HashSet};

use cones::Atlas;
use geom::{EdgeData, Mesh, Model, VertexId};
use petgraph::graph::UnGraph;
use petgraph::visit::EdgeRef;

/// The (extremum, saddle) pairs of the sublevel filtration by reducing the boundary matrix of vertices and edges over two
/// elements, column by column from left to right (Edelsbrunner, Letscher & Zomorodian 2002), in the order of the extrema.
/// Those without a saddle are essential; an extremum may be its own saddle's equal in value.
pub fn pairs_by_reduction(graph: &UnGraph<(), ()>, field: &[f64]) -> Vec<(usize, Option<usize>)> {
    let mut order: Vec<usize> = (0..field.len()).collect();
    order.sort_by(|&a, &b| field[a].partial_cmp(&field[b]).unwrap_or(Ordering::Equal).then(a.cmp(&b)));
    let mut rank = vec![0; field.len()];
    order.iter().enumerate().for_each(|(place, &v)| rank[v] = place);
    // The boundary of an edge, later end first; a loop has none.
    let boundary = |ends: [usize; 2]| [rank[ends[0]].max(rank[ends[1]]), rank[ends[0]].min(rank[ends[1]])];
    let mut columns: Vec<[usize; 2]> =
        graph.edge_references().map(|e| boundary([e.source().index(), e.target().index()])).collect();
    columns.retain(|[late, early]| late != early);
    columns.sort_unstable();
    // A vertex enters with its own column, which is zero; then the edges that it completes.
    let mut reduced: HashMap<usize, [usize; 2]> = HashMap::new();
    let mut death = vec![None; field.len()];
    for [enters, mut early] in columns {
        let mut late = enters;
        // Two rows at most are ever nonzero: adding the column with the same pivot replaces it by that column's other row.
        while late != early {
            let Some(&[_, other]) = reduced.get(&late) else {
                reduced.insert(late, [late, early]);
                death[late] = Some(enters);
                break;
            };
            (late, early) = (other.max(early), other.min(early));
        }
    }
    let is_extremum = |place: &usize| death[*place] != Some(*place);
    let mut pairs: Vec<_> =
        (0..field.len()).filter(is_extremum).map(|place| (order[place], death[place].map(|d| order[d]))).collect();
    pairs.sort_unstable();
    pairs
}

/// Solves A x = b by Gaussian elimination with pivots from the column; none if A is singular to working precision.
pub fn solve_densely(mut rows: Vec<Vec<f64>>, mut b: Vec<f64>) -> Option<Vec<f64>> {
    let n = b.len();
    let largest = rows.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| rows[i][k].abs().total_cmp(&rows[j][k].abs()))?;
        if rows[pivot][k].abs() <= 1e-14 * largest {
            return None;
        }
        rows.swap(k, pivot);
        b.swap(k, pivot);
        for i in k + 1..n {
            let factor = rows[i][k] / rows[k][k];
            let (above, below) = rows.split_at_mut(i);
            below[0].iter_mut().zip(&above[k]).for_each(|(x, pivot)| *x -= factor * pivot);
            b[i] -= factor * b[k];
        }
    }
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| rows[k][j] * b[j]).sum();
        b[k] = (b[k] - known) / rows[k][k];
    }
    Some(b)
}

/// The length of a minimum spanning tree of the terminals' distances along edges: all distances by Floyd and Warshall's
/// algorithm, the tree by Prim's.
pub fn terminal_tree_length(mesh: &Mesh, lengths: &EdgeData<f64>, terminals: &[VertexId]) -> f64 {
    let n = mesh.vertex_count();
    let mut distance = vec![vec![f64::INFINITY; n]; n];
    for e in mesh.edges() {
        let [a, b] = mesh.ends(e).map(|v| v.0 as usize);
        distance[a][b] = distance[a][b].min(lengths[e]);
        distance[b][a] = distance[a][b];
    }
    (0..n).for_each(|v| distance[v][v] = 0.0);
    for k in 0..n {
        for i in 0..n {
            for j in 0..n {
                distance[i][j] = distance[i][j].min(distance[i][k] + distance[k][j]);
            }
        }
    }
    let to_nearest = |inside: &[usize], v: usize| inside.iter().map(|&u| distance[u][v]).fold(f64::INFINITY, f64::min);
    let mut total = 0.0;
    let mut inside: Vec<usize> = terminals.iter().take(1).map(|v| v.0 as usize).collect();
    let mut outside: Vec<usize> = terminals.iter().skip(1).map(|v| v.0 as usize).collect();
    let nearer = |inside: &[usize], v: usize, w: usize| to_nearest(inside, v).total_cmp(&to_nearest(inside, w));
    while let Some(k) = (0..outside.len()).min_by(|&i, &j| nearer(&inside, outside[i], outside[j])) {
        let v = outside.swap_remove(k);
        total += to_nearest(&inside, v);
        inside.push(v);
    }
    total
}

/// What a look at a model's map to the plane finds. It asks nothing of the method that made the map.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MapCheck {
    /// Triangles with area in space that are clockwise in the plane.
    pub flipped: usize,
    /// Triangles with area in space and none in the plane.
    pub degenerate: usize,
    /// Edges that are torn, though no seam runs along them.
    pub torn: usize,
    /// The largest relative difference in length between the two sides of a seam's edge, but at necks.
    pub seam_mismatch: f64,
    /// The largest angle defect in the plane at inner vertices that are no cones, on no loop of a handle that was opened and on no neck; every corner's angle counts.
    pub curvature: f64,
    /// V - E + F of each island.
    pub euler: Vec<i64>,
    /// The largest relative difference between an edge's length in space and in the plane.
    pub stretch: f64,
}

/// Looks at the map of a model of triangles that is a manifold. Its cones may have curvature, and islands hang together over
/// the edges along which no seam runs.
///
/// # Panics
/// If there is not one position a corner.
pub fn check_map(model: &Model, atlas: &Atlas) -> MapCheck {
    let uv = &atlas.uv;
    let ends = |two: &[u32]| [two[0].min(two[1]), two[0].max(two[1])];
    let seams: HashSet<[u32; 2]> = atlas.seams.iter().flat_map(|chain| chain.windows(2).map(ends)).collect();
    assert_eq!(uv.len(), model.corner_count());
    let (rest, loops) = atlas.seams.split_at(atlas.seams.len() - atlas.opened_handles);
    let (_, necks) = rest.split_at(rest.len() - atlas.necks);
    let on_necks: HashSet<[u32; 2]> = necks.iter().flat_map(|chain| chain.windows(2).map(ends)).collect();
    let mut check = MapCheck::default();
    let mut angle_sum = vec![0.0; model.vertex_count()];
    let mut sides: HashMap<[u32; 2], Vec<[usize; 2]>> = HashMap::new();
    for f in 0..model.face_count() {
        let corners: Vec<usize> = model.face_corners(f).collect();
        let signed = signed_area([0, 1, 2].map(|k| uv[corners[k]]));
        let in_space = area([0, 1, 2].map(|k| model.points()[model.corners()[corners[k]] as usize]));
        check.flipped += usize::from(in_space > 0.0 && signed < 0.0);
        check.degenerate += usize::from(in_space > 0.0 && signed == 0.0);
        for k in 0..3 {
            let [here, next, last] = [k, (k + 1) % 3, (k + 2) % 3].map(|k| corners[k]);
            angle_sum[model.corners()[here] as usize] += angle(uv[here], uv[next], uv[last]);
            let [a, b] = [here, next].map(|c| model.corners()[c]);
            let (ends, side) = if a < b { ([a, b], [here, next]) } else { ([b, a], [next, here]) };
            sides.entry(ends).or_default().push(side);
            let [in_space, in_plane] =
                [length3(model.points()[a as usize], model.points()[b as usize]), length2(uv[here], uv[next])];
            check.stretch = check.stretch.max((in_plane - in_space).abs() / in_space);
        }
    }
    let mut is_inner = vec![true; model.vertex_count()];
    let mut islands = Islands::new(model);
    for (ends, sides) in &sides {
        if let [s, t] = sides[..] {
            if !seams.contains(ends) {
                check.torn += usize::from(s.map(|c| uv[c]) != t.map(|c| uv[c]));
                islands.glue(s, t);
            } else if !on_necks.contains(ends) {
                let [l, m] = [s, t].map(|s| length2(uv[s[0]], uv[s[1]]));
                check.seam_mismatch = check.seam_mismatch.max((l - m).abs() / (0.5 * (l + m)));
            }
        } else {
            ends.iter().for_each(|&v| is_inner[v as usize] = false);
        }
    }
    atlas.cones.iter().for_each(|cone| is_inner[cone.vertex as usize] = false);
    loops.iter().chain(necks).flatten().for_each(|&v| is_inner[v as usize] = false);
    for v in (0..model.vertex_count()).filter(|&v| is_inner[v]) {
        check.curvature = check.curvature.max((std::f64::consts::TAU - angle_sum[v]).abs());
    }
    check.euler = islands.euler();
    check
}

/// Faces joined to islands, corners to their vertices.
struct Islands {
    face_of: Vec<u32>,
    faces: petgraph::unionfind::UnionFind<u32>,
    corners: petgraph::unionfind::UnionFind<u32>,
    glued: Vec<u32>,
}

impl Islands {
    fn new(model: &Model) -> Self {
        let face_of = (0..model.face_count()).flat_map(|f| model.face(f).iter().map(move |_| f as u32)).collect();
        let faces = petgraph::unionfind::UnionFind::new(model.face_count());
        Self { face_of, faces, corners: petgraph::unionfind::UnionFind::new(model.corner_count()), glued: Vec::new() }
    }

    fn glue(&mut self, s: [usize; 2], t: [usize; 2]) {
        self.faces.union(self.face_of[s[0]], self.face_of[t[0]]);
        self.corners.union(s[0] as u32, t[0] as u32);
        self.corners.union(s[1] as u32, t[1] as u32);
        self.glued.push(self.face_of[s[0]]);
    }

    /// V - E + F of each island, by its lowest face.
    fn euler(&self) -> Vec<i64> {
        let mut euler = vec![0; self.faces.len()];
        let mut has_faces = vec![false; self.faces.len()];
        for (corner, &f) in self.face_of.iter().enumerate() {
            let island = self.faces.find(f) as usize;
            euler[island] += i64::from(self.corners.find(corner as u32) == corner as u32) - 1;
        }
        for f in 0..self.faces.len() as u32 {
            euler[self.faces.find(f) as usize] += 1;
            has_faces[self.faces.find(f) as usize] = true;
        }
        for &f in &self.glued {
            euler[self.faces.find(f) as usize] += 1;
        }
        (0..euler.len()).filter(|&f| has_faces[f]).map(|f| euler[f]).collect()
    }
}

/// The angle at p between the directions to q and r.
fn angle(p: [f64; 2], q: [f64; 2], r: [f64; 2]) -> f64 {
    let (a, b) = ([q[0] - p[0], q[1] - p[1]], [r[0] - p[0], r[1] - p[1]]);
    (a[0] * b[1] - a[1] * b[0]).atan2(a[0] * b[0] + a[1] * b[1]).abs()
}

/// Twice the area of a triangle in the plane, positive if it runs counter-clockwise.
pub fn signed_area([p, q, r]: [[f64; 2]; 3]) -> f64 {
    (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
}

/// The area of a triangle in space.
pub fn area([p, q, r]: [[f64; 3]; 3]) -> f64 {
    let (a, b) = ([0, 1, 2].map(|k| q[k] - p[k]), [0, 1, 2].map(|k| r[k] - p[k]));
    let cross = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
    0.5 * (cross(1, 2).powi(2) + cross(2, 0).powi(2) + cross(0, 1).powi(2)).sqrt()
}

fn length2(p: [f64; 2], q: [f64; 2]) -> f64 {
    (q[0] - p[0]).hypot(q[1] - p[1])
}

fn length3(p: [f64; 3], q: [f64; 3]) -> f64 {
    (0..3).map(|k| (q[k] - p[k]).powi(2)).sum::<f64>().sqrt()
}

//! The common refinement of the input's triangles and the intrinsic ones.

use super::SurfacePoint;
use super::cut::{Cut, Node};
use super::overlay::Overlay;
use super::plane::{Point, minus, wedge};
use crate::mesh::{EdgeId, FaceData, FaceId, HalfedgeId, Id, Triangulation, VertexData};
use crate::watch::{Interrupted, Watch};

/// The watch is asked once for so many intrinsic triangles.
const STRIDE: usize = 1 << 14;

/// Triangles each of which is part of one triangle of the input and of one intrinsic triangle: the input's surface, cut
/// where edges of either run. Where edges of the input are left out, a triangle may be part of several.
#[derive(Clone, Debug)]
pub struct CommonRefinement {
    /// Where each vertex is on the input: first the intrinsic triangulation's vertices, then the crossings of edges.
    pub place: VertexData<SurfacePoint>,
    /// The vertices of each triangle, counter-clockwise.
    pub triangles: FaceData<[u32; 3]>,
    /// The triangle of the input that each is part of; one of them, where edges are left out.
    pub input: FaceData<FaceId>,
    /// The intrinsic triangle that each is part of. Those of one are next to each other, in the order of intrinsic triangles.
    pub intrinsic: FaceData<FaceId>,
    /// Where each corner of each triangle is on its intrinsic triangle: on the side of this halfedge, so far along it.
    pub corner: FaceData<[(HalfedgeId, f64); 3]>,
    /// The first vertex among the crossings of each intrinsic edge, which follow each other along the halfedge that names it.
    first_crossing: Vec<u32>,
}

impl CommonRefinement {
    /// `home` names a triangle of the input that each intrinsic one has a part of, where edges were [left out](Overlay::leave_out).
    pub(super) fn new(
        input: &Triangulation,
        overlay: &Overlay,
        home: Option<&FaceData<FaceId>>,
        watch: Watch,
    ) -> Result<Self, Interrupted> {
        let mut place = overlay.place.clone();
        let mut first_crossing = Vec::with_capacity(overlay.triangulation.edge_count() + 1);
        for e in overlay.triangulation.edges() {
            first_crossing.push(place.len() as u32);
            place.extend(
                overlay.crossed_at(e).iter().map(|crossing| SurfacePoint::Edge(crossing.halfedge, crossing.along)),
            );
        }
        first_crossing.push(place.len() as u32);
        let mut common = Self {
            place: place.into(),
            triangles: Vec::new().into(),
            input: Vec::new().into(),
            intrinsic: Vec::new().into(),
            corner: Vec::new().into(),
            first_crossing,
        };
        watch.ask(0.2)?;
        common.fill((input, overlay, home), watch.within(0.2, 1.0))?;
        Ok(common)
    }

    fn fill(
        &mut self,
        (input, overlay, known): (&Triangulation, &Overlay, Option<&FaceData<FaceId>>),
        watch: Watch,
    ) -> Result<(), Interrupted> {
        let (mut triangles, mut homes, mut intrinsic, mut corners) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let count = overlay.triangulation.face_count();
        for f in overlay.triangulation.faces() {
            if f.index().is_multiple_of(STRIDE) {
                watch.ask(f.index() as f64 / count as f64)?;
            }
            let cut = overlay.cut(f);
            let layout = overlay.layout(f);
            let sides = overlay.triangulation.sides(f);
            for cell in cut.cells() {
                let polygon = cut.polygon(cell);
                let alone = known.filter(|_| cut.rim(cell).is_none()).map(|home| home[f]);
                let home = alone.unwrap_or_else(|| overlay.home(f, &cut, cell));
                debug_assert!(home.index() < input.face_count());
                for part in fan(&cut, &layout, &polygon) {
                    triangles.push(part.map(|node| self.vertex(overlay, f, node)));
                    homes.push(home);
                    intrinsic.push(f);
                    corners.push(part.map(|node| match node {
                        Node::Corner(s) => (sides[s], 0.0),
                        Node::Side(s, k) => (sides[s], cut.sides[s][k].at),
                    }));
                }
            }
        }
        (self.triangles, self.input) = (triangles.into(), homes.into());
        (self.intrinsic, self.corner) = (intrinsic.into(), corners.into());
        Ok(())
    }

    fn vertex(&self, overlay: &Overlay, f: FaceId, node: Node) -> u32 {
        let t = &overlay.triangulation;
        match node {
            Node::Corner(s) => t.corners(f)[s].0,
            Node::Side(s, k) => {
                let h = t.sides(f)[s];
                let e = t.edge(h);
                let along = if t.halfedge(e) == h { k } else { overlay.crossing_count(e) - 1 - k };
                self.first_crossing[e.index()] + along as u32
            }
        }
    }

    /// The vertices where an intrinsic edge is crossed, in order along the halfedge that names it.
    pub fn crossings(&self, e: EdgeId) -> std::ops::Range<u32> {
        self.first_crossing[e.index()]..self.first_crossing[e.index() + 1]
    }

    /// The positions of the vertices in space, those of the input's given.
    ///
    /// # Panics
    /// If there are fewer points than the input has vertices.
    pub fn positions(&self, input: &Triangulation, points: &[[f64; 3]]) -> Vec<[f64; 3]> {
        self.place.iter().map(|place| place.position(input, points)).collect()
    }
}

/// A convex polygon as triangles from the corner where the thinnest of them is least thin.
fn fan(cut: &Cut, layout: &[Point; 3], polygon: &[Node]) -> Vec<[Node; 3]> {
    let count = polygon.len();
    let from = |first: usize| -> Vec<[Node; 3]> {
        (1..count - 1).map(|k| [0, k, k + 1].map(|k| polygon[(first + k) % count])).collect()
    };
    if count == 3 {
        return from(0);
    }
    let fatness = |triangle: &[Node; 3]| {
        let [a, b, c] = triangle.map(|node| cut.position(layout, node));
        let longest = [(a, b), (b, c), (c, a)].iter().fold(0.0, |most: f64, &(p, q)| {
            let [x, y] = minus(q, p);
            most.max(x * x + y * y)
        });
        wedge(minus(b, a), minus(c, a)) / longest.max(f64::MIN_POSITIVE)
    };
    let thinnest = |first: usize| from(first).iter().map(fatness).fold(f64::INFINITY, f64::min);
    let best = (0..count).map(|first| (thinnest(first), first));
    let (_, first) = best.fold((f64::NEG_INFINITY, 0), |best, next| if next.0 > best.0 { next } else { best });
    from(first)
}

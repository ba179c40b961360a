//! Surfaces opened along the seams that are given, so that what they leave is flattened for itself.
//!
//! Whoever says where seams run has chosen charts. With cones on the whole surface the two sides of such a seam would stay congruent, and a chart round by
//! itself become a polygon, its corners the cones that the other side needs. Opened, each chart has a boundary that takes curvature, with the log
//! scale factor 0 along it: of all conformal maps that is the one that distorts areas least (Springborn, Schröder & Pinkall 2008; Sawhney & Crane 2017), and needs
//! few cones or none.

use std::collections::HashSet;

use geom::{EdgeData, OpenedIsland, VertexData, open_islands};

use super::Analysis;
use super::atlas::Atlas;
use super::component::Component;
use super::flat::RIGID_SEAMS;
use super::limbs::CutOff;
use super::observer::{Task, Times};
use super::options::{ConeChoice, FreeSeams, Options};
use crate::cut::{SeamFigures, SeamOptions, ascending, named_edges};
use crate::error::Error;
use crate::flatten::{Chain, Seams, seam_lengths};

impl Options {
    /// Whether surfaces are opened along the seams that are given. Cones that are given, or numbers of them for each part, speak of whole surfaces.
    fn opens_given_seams(&self) -> bool {
        let is_given = !self.seams.given.is_empty() || !self.seams.kept.is_empty();
        let is_of_whole = match &self.cones {
            ConeChoice::Recipe(recipe) => !recipe.charts,
            cones => matches!(cones, ConeChoice::Given(_) | ConeChoice::Each(_)),
        };
        is_given && self.free_seams != FreeSeams::Never && self.quantize.is_none() && !is_of_whole
    }
}

impl Analysis {
    /// The atlas of the model opened along the seams that are given; none where these stay rigid, or are none of its edges.
    ///
    /// # Errors
    /// As [`atlas`](Self::atlas).
    pub(super) fn atlas_along_seams(&self, options: &Options) -> Result<Option<Atlas>, Error> {
        if !options.opens_given_seams() {
            return Ok(None);
        }
        let in_parts = options.seams.in_parts(|ends| self.parts(ends));
        let named: HashSet<[u32; 2]> =
            in_parts.given.iter().chain(&in_parts.kept).map(|&ends| ascending(ends)).collect();
        let charts: Vec<Option<Charts>> =
            self.components().iter().map(|component| Charts::new(component, self.corner_vertices(), &named)).collect();
        if charts.iter().all(Option::is_none) {
            return Ok(None);
        }
        let chains: Vec<Vec<Chain>> =
            charts.iter().map(|charts| charts.as_ref().map_or(Vec::new(), |charts| charts.chains.clone())).collect();
        let mut times = Times::default();
        let cut = self.cut_into(charts, &mut times)?;
        // What is given is open now.
        let seams = SeamOptions { given: Vec::new(), kept: Vec::new(), ..options.seams.clone() };
        let of_charts = cut.analysis.atlas(&Options { seams, ..options.clone() });
        let mut atlas = cut.put_back(of_charts)?;
        atlas.recipe.charts = true;
        for (component, chains) in self.components().iter().zip(&chains) {
            let Component { surface, metric, .. } = &**component;
            let figures = SeamFigures::of_mapped_chains(surface, metric, chains, &atlas.uv);
            atlas.freed += usize::from(figures.mean_mismatch() > RIGID_SEAMS);
            atlas.seam_figures += figures;
        }
        atlas.notes.extend(self.notes_of_seams(&options.seams));
        atlas.times += times;
        Ok(Some(atlas))
    }

    /// The model with some parts in charts.
    fn cut_into(&self, charts: Vec<Option<Charts>>, times: &mut Times) -> Result<CutOff, Error> {
        let mut before: Vec<usize> = (0..charts.len()).collect();
        let (mut ready, mut given) = (Vec::new(), Vec::new());
        for (component, charts) in self.components().iter().zip(charts) {
            let Some(Charts { islands, chains }) = charts else { continue };
            component.let_factor_go();
            given.extend(chains.iter().map(|chain| component.vertices_along(chain)));
            let whole = component.ready();
            for (k, island) in islands.into_iter().enumerate() {
                let place = if k == 0 { component.index } else { before.len() };
                if k > 0 {
                    before.push(component.index);
                }
                ready.push((place, whole.island(island, place).in_unit_size()));
            }
        }
        let task = Task::new(&self.observer, before.len());
        let found = self.found.in_pieces(self, ready, true, &task, times)?;
        Ok(CutOff::along_seams(Self { found: found.into(), observer: self.observer.clone() }, before, given))
    }
}

/// What a surface falls into along given seams.
struct Charts {
    islands: Vec<OpenedIsland>,
    chains: Vec<Chain>,
}

impl Charts {
    /// Those of a component; none where no edge of it is named. Edges inside polygons, on the boundary and on opened handles are none.
    fn new(component: &Component, corners: &[u32], named: &HashSet<[u32; 2]>) -> Option<Self> {
        let Component { surface, metric, handles, .. } = component;
        let mesh = &surface.mesh;
        if handles.of_vertex.is_some() {
            return None;
        }
        let mut cut: EdgeData<bool> = named_edges(surface, corners, named);
        mesh.edges().filter(|&e| mesh.is_boundary_edge(e)).for_each(|e| cut[e] = false);
        if !cut.contains(&true) {
            return None;
        }
        let islands = open_islands(mesh, &cut);
        let no_ends = VertexData::constant(mesh.vertex_count(), false);
        let chains = Seams::of_cut(mesh, &seam_lengths(surface, metric), cut, &no_ends).chains;
        Some(Self { islands, chains })
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use geom::{EdgeId, Id, Model, shapes};

    use super::*;
    use crate::cut::Symmetry;

    /// A sphere, and the edges between its halves.
    fn halves() -> (Model, Vec<[u32; 2]>) {
        let shape = shapes::sphere(1500);
        let is_upper = |triangle: [u32; 3]| triangle.iter().map(|&v| shape.points[v as usize][2]).sum::<f64>() > 0.0;
        let mesh = shape.mesh();
        let is_between = |e: &EdgeId| {
            let h = mesh.halfedge(*e);
            let sides = [h, mesh.twin(h).unwrap()].map(|h| is_upper(shape.triangles[mesh.face(h).index()]));
            sides[0] != sides[1]
        };
        let between = mesh.edges().filter(is_between).map(|e| mesh.ends(e).map(|v| v.0)).collect();
        (shape.into(), between)
    }

    fn unwrapped(model: &Model, given: &[[u32; 2]], options: Options) -> (Analysis, Atlas) {
        let seams = SeamOptions { given: given.to_vec(), ..SeamOptions::default() };
        Analysis::unwrapped(model, &Options { seams, ..options }, super::super::observer::Silent).unwrap()
    }

    fn edges(atlas: &Atlas) -> HashSet<[u32; 2]> {
        atlas.seams.iter().flat_map(|seam| seam.windows(2).map(|ends| ascending([ends[0], ends[1]]))).collect()
    }

    #[test]
    fn cones_keep_off_a_region_whose_edges_are_to_be_avoided() {
        let model: Model = shapes::by_name("terrain", 1500).unwrap().into();
        for cones in [ConeChoice::Count(6), ConeChoice::WithinDistortion(1.05)] {
            let plain = Options { cones, ..Options::default() };
            let (_, atlas) = unwrapped(&model, &[], plain.clone());
            let centre = atlas.cones[0].position;
            let far = |v: u32| (0..3).map(|k| (model.points()[v as usize][k] - centre[k]).powi(2)).sum::<f64>();
            let mut near: Vec<u32> = (0..model.vertex_count() as u32).collect();
            near.sort_by(|&v, &w| far(v).total_cmp(&far(w)));
            near.truncate(60);
            let corners = model.corners().chunks(3).flat_map(|t| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]]);
            let avoid: Vec<[u32; 2]> = corners.filter(|ends| ends.iter().all(|v| near.contains(v))).collect();
            let cuts_one = |atlas: &Atlas| {
                let cut = edges(atlas);
                avoid.iter().any(|&ends| cut.contains(&ascending(ends)))
            };
            assert!(cuts_one(&atlas), "the region has a cone in it");
            let seams = SeamOptions { avoid: avoid.clone(), ..SeamOptions::default() };
            let options = Options { seams, ..plain };
            let (_, atlas) = Analysis::unwrapped(&model, &options, super::super::observer::Silent).unwrap();
            assert!(!cuts_one(&atlas), "{:?}", atlas.notes);
        }
    }

    #[test]
    fn halves_of_a_sphere_need_fewer_cones_and_their_sides_fit() {
        let (model, given) = halves();
        let (analysis, free) = unwrapped(&model, &given, Options::default());
        let rigid = Options { free_seams: FreeSeams::Never, ..Options::default() };
        let (as_whole, rigid) = unwrapped(&model, &given, rigid);
        let areas = |analysis: &Analysis, atlas: &Atlas| analysis.measures(atlas).unwrap().area.mean;
        assert!(free.cones.len() < rigid.cones.len() && rigid.freed == 0);
        assert!(areas(&analysis, &free) < areas(&as_whole, &rigid));
        assert_eq!((free.island_count(), free.detached.len()), (2, 0));
        // The scale is 1 along the boundary.
        assert!(free.seam_figures.mean_mismatch() < 1e-6 && free.freed == 0);
        let cut = edges(&free);
        assert!(given.iter().all(|&ends| cut.contains(&ascending(ends))));
        assert!(free.cones.iter().all(|cone| cone.component == 0), "it is one part");
        assert!((free.seam_figures.length / rigid.seam_figures.length - 1.0).abs() < 0.3);
    }

    #[test]
    fn no_cones_may_be_asked_for_where_charts_need_none() {
        let (model, given) = halves();
        let none = Options { cones: ConeChoice::Count(0), ..Options::default() };
        let (_, atlas) = unwrapped(&model, &given, none.clone());
        assert_eq!((atlas.cones.len(), atlas.island_count()), (0, 2));
        assert_eq!(edges(&atlas), given.iter().map(|&ends| ascending(ends)).collect());
        // A slit is opened, too, and takes what cones would take.
        let slit: Vec<[u32; 2]> =
            given.iter().copied().filter(|ends| ends.iter().all(|&v| model.points()[v as usize][0] > -0.8)).collect();
        assert!(slit.len() < given.len());
        let (_, atlas) = unwrapped(&model, &slit, none.clone());
        assert_eq!((atlas.cones.len(), atlas.island_count()), (0, 1));
        let refine = Options {
            preparation: super::super::Preparation { refine: super::super::Refining::Always, ..none.preparation },
            ..none
        };
        let (analysis, atlas) = unwrapped(&model, &given, refine);
        assert_eq!((atlas.cones.len(), atlas.island_count()), (0, 2));
        assert!(analysis.refined().is_some() && atlas.detached.is_empty());
    }

    #[test]
    fn what_was_found_makes_the_same_map_again() {
        let (model, given) = halves();
        let (_, atlas) = unwrapped(&model, &given, Options::default());
        assert!(atlas.recipe().charts);
        let again = Options { cones: ConeChoice::Recipe(Box::new(atlas.recipe().clone())), ..Options::default() };
        let (_, again) = unwrapped(&model, &given, again);
        assert_eq!(again.uv, atlas.uv);
    }

    #[test]
    fn cones_of_charts_are_refused_without_their_seams() {
        let (model, given) = halves();
        // Of a few edges of the seam the surface is opened along a slit, and has a cone for what that does not take.
        let (_, atlas) = unwrapped(&model, &given[..3], Options { cones: ConeChoice::Count(4), ..Options::default() });
        assert!(atlas.recipe().charts && atlas.cones.len() == 4);
        let again = Options { cones: ConeChoice::Recipe(Box::new(atlas.recipe().clone())), ..Options::default() };
        let refused = Analysis::unwrapped(&model, &again, crate::analysis::observer::Silent).unwrap_err();
        assert!(matches!(refused, Error::OtherSeams), "{refused}");
    }

    #[test]
    fn sides_stay_congruent_for_textures_and_for_cones_that_are_given() {
        let (model, given) = halves();
        let tiled = Options { quantize: Some(Symmetry::Fourfold), cones: ConeChoice::Count(8), ..Options::default() };
        let cones = (0..4).map(|k| (300 * k, None)).collect();
        for options in [tiled, Options { cones: ConeChoice::Given(cones), ..Options::default() }] {
            assert!(
                !Options { seams: SeamOptions { given: given.clone(), ..SeamOptions::default() }, ..options.clone() }
                    .opens_given_seams()
            );
            let (_, atlas) = unwrapped(&model, &given, options);
            assert!(atlas.cones.len() >= 4 && atlas.freed == 0);
        }
        assert!(!Options::default().opens_given_seams());
    }
}

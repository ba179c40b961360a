//! The options of looking for cones.

use super::numbers::{distortion, non_negative, whole};
use super::welded::WeldArgs;
use crate::output;
use crate::report::table::{counted, thousands};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};
use cones::{
    Analysis, ConeChoice, ConeOrder, CurvatureRule, Handles, Options, Placement, Preparation, Refining, Search,
};
use geom::Model;
use geom::io::with_split_edges;
use std::path::Path;

/// How many cones, by which method, and what curvatures they get.
#[derive(Args, Debug)]
pub(crate) struct CandidateArgs {
    /// How many cones in all [default: in each part as few as are predicted to keep its area distortion within 1.25; where
    /// these are over 32, the best 32 if they keep it within 1.3, else about as few as do; a few more if these leave none]
    #[arg(short = 'n', value_name = "N", group = "which", value_parser = whole::<usize>("number of cones", 0..), allow_negative_numbers = true)]
    count: Option<usize>,
    /// As few cones as keep the area distortion within this, as predicted; `unwrap` makes sure by flattening
    #[arg(long, value_name = "D", group = "which", value_parser = distortion, allow_negative_numbers = true)]
    max_distortion: Option<f64>,
    /// All extrema of the conformal factor that are more persistent than this
    #[arg(long, value_name = "P", group = "which", value_parser = non_negative, allow_negative_numbers = true)]
    min_persistence: Option<f64>,
    /// How cones are chosen; `refined` chooses more than 512 by persistence, `pursuit`
    /// more than 64 [default: refined]
    #[arg(long, value_parser = placements())]
    method: Option<Placement>,
    /// How thoroughly `refined` and `pursuit` look for cones
    #[arg(long, value_enum, default_value_t = SearchName::Coarse)]
    search: SearchName,
    /// How curvature is shared among the cones [default: optimal]
    #[arg(long, value_enum)]
    angles: Option<AnglesName>,
    /// Diffuse the curvature before extrema are looked for: steadier on noisy scans. It acts on the methods `persistence` and
    /// `alternating` and on --min-persistence; the others read no extrema
    #[arg(long)]
    smooth: bool,
    #[command(flatten)]
    weld: WeldArgs,
    /// Close the surface where vertices lie on the edges of other faces (T-junctions): these faces are written with a corner there
    #[arg(long)]
    split_edges: bool,
    /// Refine the surface until its triangles are even, whatever the file has: what is written is the same surface in more
    /// triangles, with the exact map
    /// [default: needles for STL, never otherwise]
    #[arg(long, value_enum, value_name = "WHEN", num_args = 0..=1, require_equals = true, default_missing_value = "always")]
    refine: Option<RefineName>,
    /// Unwrap the surface as if its small holes were filled, so that seams need not run to them: boundary loops no longer than SIZE roots of their part's
    /// area [default: none, without SIZE 0.5]
    #[arg(long, value_name = "SIZE", num_args = 0..=1, require_equals = true, default_missing_value = "0.5", value_parser = non_negative)]
    fill_holes: Option<f64>,
    /// Open handles along short loops that take curvature, so that fewer cones are enough
    #[arg(long, value_enum, value_name = "WHEN", default_value_t = HandlesName::Auto)]
    open_handles: HandlesName,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum HandlesName {
    /// Where that promises much less distortion, or far fewer cones
    Auto,
    /// Leave them closed
    Never,
    /// All of them
    Always,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum RefineName {
    /// Leave it as it is
    Never,
    /// Where more than a twentieth of the area is in needles, or angles would be bent and a refined map is better
    Needles,
    /// Whatever it is
    Always,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum SearchName {
    /// On a coarse level where a surface has 8,000 vertices or more, then round what is found there
    Coarse,
    /// On all vertices: six to eight times as long, for cones that are less than a hundredth better
    Full,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum AnglesName {
    /// By least squares: the least variation of scale with these cones
    Optimal,
    /// As in the paper: no change of scale at the cones
    Harmonic,
}

/// The library's methods by their names.
fn placements() -> impl TypedValueParser<Value = Placement> {
    let values = Placement::ALL.map(|placement| PossibleValue::new(placement.name()).help(placement.description()));
    let named = |name: String| Placement::ALL.into_iter().find(|placement| placement.name() == name);
    PossibleValuesParser::new(values).map(move |name| named(name).expect("it is one of their names"))
}

impl CandidateArgs {
    /// An option that is there, if any is: what is no surface has no cones.
    pub(crate) fn first_given(&self) -> Option<&'static str> {
        let given = [
            (self.count.is_some(), "-n"),
            (self.max_distortion.is_some(), "--max-distortion"),
            (self.min_persistence.is_some(), "--min-persistence"),
            (self.smooth, "--smooth"),
            (self.weld.is_given(), "--weld"),
            (self.split_edges, "--split-edges"),
            (self.refine.is_some(), "--refine"),
            (self.fill_holes.is_some(), "--fill-holes"),
        ];
        given.into_iter().find_map(|(is_given, option)| is_given.then_some(option))
    }

    /// The model with its edges split, where that is asked for and closes anything, and what is said of it.
    pub(crate) fn with_edges_split(&self, model: Model) -> (Model, Option<String>) {
        let weld = self.weld.chosen();
        let Some(split) = self.split_edges.then(|| model.with_edges_split(weld)).flatten() else {
            return (model, None);
        };
        let of_faces = counted(split.faces, "face has", "faces have");
        let told = match split.vertices {
            1 => format!("1 vertex lay on the edges of other faces: {of_faces} more corners"),
            vertices => {
                format!("{} vertices lay on the edges of other faces: {of_faces} more corners", thousands(vertices))
            }
        };
        (with_split_edges(&model, split.model), Some(told))
    }

    /// Says that --smooth changes no cones where no extrema are looked for.
    pub(crate) fn warn_of_idle_smoothing(&self) {
        let method = self.method.unwrap_or_default();
        let method = self.count.map_or(method, |count| method.for_count(count));
        if self.smooth && self.min_persistence.is_none() && !method.reads_extrema() {
            output::warn(
                "--smooth changes none of these cones: it acts on --method persistence and alternating, and on --min-persistence",
            );
        }
    }

    /// Says which options change nothing about cones that a file gives.
    pub(crate) fn warn_of_idle_choice(&self, options: &Options) {
        if self.method.is_some() && options.cones.is_given() {
            output::warn("--method changes none of these cones: the file of --cones gives them");
        }
        if self.angles.is_some() && options.gives_curvatures() {
            output::warn("--angles changes none of these curvatures: the file of --cones gives them");
        }
    }

    /// The order of cones that a hierarchy file holds: of the method that was asked for, for as many cones as were taken.
    pub(crate) fn order(&self, analysis: &Analysis, taken: usize) -> Result<ConeOrder, cones::Error> {
        let Options { placement, rule, cones, .. } = self.options();
        match cones {
            ConeChoice::Count(asked) => analysis.order(placement, rule, asked),
            ConeChoice::MinPersistence(_) => analysis.order(Placement::Persistence, rule, taken),
            _ => analysis.order(placement, rule, taken),
        }
    }

    /// The library's options for a file.
    pub(crate) fn options_for(&self, input: &Path) -> Options {
        let mut options = self.options();
        let name = input.to_string_lossy().to_ascii_lowercase();
        // An STL has no vertices of its own to keep.
        if self.refine.is_none() && (name.ends_with(".stl") || name.ends_with(".stl.gz")) {
            options.preparation.refine = Refining::Needles;
        }
        options
    }

    /// The library's options, whatever the kind of file.
    pub(crate) fn options(&self) -> Options {
        let cones = match (self.min_persistence, self.count) {
            (Some(persistence), _) => ConeChoice::MinPersistence(persistence),
            (_, Some(count)) => ConeChoice::Count(count),
            (None, None) => self.max_distortion.map_or(ConeChoice::Automatic, ConeChoice::WithinDistortion),
        };
        let rule = match self.angles {
            None | Some(AnglesName::Optimal) => CurvatureRule::Optimal,
            Some(AnglesName::Harmonic) => CurvatureRule::Harmonic,
        };
        let search = match self.search {
            SearchName::Coarse => Search::CoarseToFine,
            SearchName::Full => Search::Full,
        };
        let refine = match self.refine {
            None | Some(RefineName::Never) => Refining::Never,
            Some(RefineName::Needles) => Refining::Needles,
            Some(RefineName::Always) => Refining::Always,
        };
        let handles = match self.open_handles {
            HandlesName::Auto => Handles::Auto,
            HandlesName::Never => Handles::Never,
            HandlesName::Always => Handles::Always,
        };
        Options {
            cones,
            placement: self.method.unwrap_or_default(),
            search,
            rule,
            preparation: Preparation {
                smooth: self.smooth,
                weld: self.weld.chosen(),
                refine,
                handles,
                fill_holes: self.fill_holes,
            },
            ..Options::default()
        }
    }
}

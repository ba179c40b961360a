//! `cones figure`: the figures of the paper, of any surface and methods, beside the values that the paper prints.
//!
//! Everything in them comes from the analysis, as in `cones unwrap` and `cones compare`: maps whose cones were placed by a method and
//! flattened exactly or by a baseline. Layouts are shown without overlaps, packed; those of baselines as they are.

mod levels;
mod maps;
mod paper;
mod sheet;

use crate::commands::compare::Variant;
use crate::commands::shape;
use crate::commands::shared::{ColourName, vertex_count, whole};
use crate::error::CommandError;
use crate::input;
use crate::output::{self, Files};
use crate::progress::Progress;
use crate::render::{Picture, View};
use crate::report::table::counted;
use clap::{Args, ValueEnum};
use cones::MOST_ORDERED;
use geom::Model;
use maps::{Map, Surface};
use paper::{Stand, stands};
use sheet::{SheetColumn, sheet};
use std::path::{Path, PathBuf};

#[derive(Args, Debug)]
pub(crate) struct FigureArgs {
    /// Which figure of the paper, or all
    #[arg(value_enum)]
    which: Which,
    /// The surfaces: OBJ, OFF, PLY, STL or glTF [default: built-in shapes]
    #[arg(value_name = "MESH")]
    meshes: Vec<PathBuf>,
    /// Where to write it: .png; with `all` a folder
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// How many cones, such as 4,8,26; in figure 1 of either method [default: those of the paper]
    #[arg(short = 'n', value_name = "N,…", value_delimiter = ',', value_parser = whole::<usize>("number of cones", 0..=MOST_ORDERED), allow_negative_numbers = true)]
    counts: Vec<usize>,
    /// Which methods, as for `cones compare` [default: those of the paper]
    #[arg(long, value_name = "M,…", value_delimiter = ',', value_parser = Variant::parse, long_help = Variant::help())]
    method: Vec<Variant>,
    /// Draw the paper's models, as far as they are in this folder, in place of built-in shapes
    #[arg(long, value_name = "DIR", conflicts_with = "meshes")]
    paper: Option<PathBuf>,
    /// From where panels are seen, as for `cones unwrap` [default: where most cones are seen]
    #[arg(long, value_name = "VIEW", value_parser = View::parse, allow_hyphen_values = true)]
    view: Option<View>,
    /// The width of a panel in pixels
    #[arg(long, value_name = "PIXELS", default_value_t = 420, value_parser = whole::<u16>("number of pixels", 200..=2000), allow_negative_numbers = true)]
    panel: u16,
    /// About how many vertices the built-in shapes have
    #[arg(long, value_name = "V", default_value_t = 8000, value_parser = vertex_count, allow_negative_numbers = true)]
    vertices: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Which {
    /// Area distortion without cones and with them
    #[value(name = "1")]
    Absorbed,
    /// The conformal factor and its extrema
    #[value(name = "2")]
    Factor,
    /// A hierarchy of maxima on a terrain
    #[value(name = "3")]
    Terrain,
    /// Cones, surface and unfolding by two methods
    #[value(name = "4")]
    Methods,
    /// Several surfaces
    #[value(name = "5")]
    Surfaces,
    /// The picture at the head of README
    Readme,
    /// All of them
    All,
}

/// A surface to draw, with what the paper prints of it if it stands in for one of its models.
struct Exhibit {
    name: String,
    model: Model,
    stand: Option<Stand>,
}

/// What is printed of a column of a figure.
struct Figured {
    column: String,
    lines: Vec<String>,
}

pub(crate) fn run(args: &FigureArgs) -> Result<(), CommandError> {
    let inputs: Vec<&Path> = args.meshes.iter().map(|path| &**path).collect();
    if args.which == Which::All {
        let source = |source| CommandError::MakeFolder { path: args.output.clone(), source };
        std::fs::create_dir_all(&args.output).map_err(source)?;
    } else {
        output::extension(&args.output, &["png"])?;
        output::check(&inputs, &[&args.output])?;
    }
    let (mut pictures, mut printed) = (Vec::new(), String::new());
    for (which, name, file) in args.files() {
        let progress = Progress::begin(&file.display().to_string());
        progress.step("draw");
        let exhibits = args.exhibits(which, name)?;
        let (picture, figured) = drawn(args, which, &exhibits)?;
        progress.finish();
        printed += &format!("{}\n", file.display());
        for Figured { column, lines } in figured {
            let told = if lines.is_empty() { String::new() } else { format!(": {}", lines.join("; ")) };
            printed += &format!("  {column}{told}\n");
        }
        pictures.push((file, picture));
    }
    let mut files = Files::new();
    pictures.iter().try_for_each(|(file, picture)| files.write_png(file, picture))?;
    files.finish()?;
    output::print(&printed)
}

impl FigureArgs {
    /// The figures to draw, each with the surface that it is of where it is of one, and its file.
    fn files(&self) -> Vec<(Which, Option<&'static str>, PathBuf)> {
        if self.which != Which::All {
            return vec![(self.which, None, self.output.clone())];
        }
        let file = |name: &str| self.output.join(format!("{name}.png"));
        let fourth = |name: &str| file(&format!("figure-4-{name}"));
        let of = |name: &'static str| (Which::Methods, Some(name), fourth(&name.to_lowercase()));
        let methods = match (self.meshes.first(), &self.paper) {
            (Some(mesh), _) => vec![(Which::Methods, None, fourth(&stem(mesh)))],
            (None, Some(_)) => vec![of("Fandisk"), of("Moai")],
            (None, None) => vec![of("part"), of("hare")],
        };
        let mut files = vec![
            (Which::Absorbed, None, file("figure-1")),
            (Which::Factor, None, file("figure-2")),
            (Which::Terrain, None, file("figure-3")),
        ];
        files.extend(methods);
        files.extend([(Which::Surfaces, None, file("figure-5")), (Which::Readme, None, file("readme"))]);
        files
    }

    /// What a figure is of.
    fn exhibits(&self, which: Which, name: Option<&str>) -> Result<Vec<Exhibit>, CommandError> {
        let built =
            |name: &str, vertices| Exhibit { name: name.to_owned(), model: shape::model(name, vertices), stand: None };
        if !self.meshes.is_empty() {
            let read =
                |path: &PathBuf| Ok(Exhibit { name: stem(path), model: input::read_model(path)?.0, stand: None });
            let meshes = if which == Which::Surfaces { &self.meshes[..] } else { &self.meshes[..1] };
            return meshes.iter().map(read).collect();
        }
        match (&self.paper, which) {
            (_, Which::Terrain) => return Ok(vec![built("terrain", 10_000)]),
            (_, Which::Readme) => return Ok(vec![built("hare", 12_000)]),
            (Some(folder), _) => {
                let wanted: Vec<&str> = match (name, which) {
                    (Some(name), _) => vec![name],
                    (None, Which::Surfaces) => vec!["Planck", "Rabbit", "Hygeia", "Armchair", "OctaFlower"],
                    (None, Which::Methods) => vec!["Moai"],
                    (None, _) => vec!["Rabbit"],
                };
                return stands(folder, &wanted)?
                    .into_iter()
                    .map(|stand| {
                        let (model, _) = input::read_model(&stand.path)?;
                        Ok(Exhibit { name: stand.model.name.to_owned(), model, stand: Some(stand) })
                    })
                    .collect();
            }
            (None, _) => {}
        }
        Ok(match (name, which) {
            (Some(name), _) => vec![built(name, self.vertices)],
            (None, Which::Surfaces) => {
                ["hare", "part", "capsule", "torus", "torus-3"].map(|name| built(name, self.vertices)).into()
            }
            (None, _) => vec![built("hare", self.vertices)],
        })
    }

    /// The size of a panel that shows a surface.
    fn panel(&self) -> [usize; 2] {
        [usize::from(self.panel), usize::from(self.panel) * 9 / 10]
    }

    fn counts_or(&self, counts: &[usize]) -> Vec<usize> {
        if self.counts.is_empty() { counts.to_vec() } else { self.counts.clone() }
    }

    fn methods_or(&self, methods: &[Variant]) -> Vec<Variant> {
        if self.method.is_empty() { methods.to_vec() } else { self.method.clone() }
    }
}

/// What a mesh is called after its file.
fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// A figure as a picture, and what is printed of its maps.
fn drawn(args: &FigureArgs, which: Which, exhibits: &[Exhibit]) -> Result<(Picture, Vec<Figured>), CommandError> {
    let columns = match which {
        Which::Absorbed => absorbed(args, &exhibits[0])?,
        Which::Factor => {
            let Exhibit { name, model, .. } = &exhibits[0];
            levels::factor(&mut Surface::new(name, model), model, args.view, args.panel())?
        }
        Which::Terrain => levels::terrain(&exhibits[0].name, &exhibits[0].model, args.view, args.panel())?,
        Which::Methods => methods(args, &exhibits[0])?,
        Which::Surfaces => surfaces(args, exhibits)?,
        Which::Readme | Which::All => return readme(args, &exhibits[0]),
    };
    let figured = columns.iter().map(|column| Figured { column: column.head.join(", "), lines: column.foot.clone() });
    let figured = figured.collect();
    Ok((sheet(&columns, args.panel()), figured))
}

/// Figure 1: what cones do for the area distortion.
fn absorbed(args: &FigureArgs, exhibit: &Exhibit) -> Result<Vec<SheetColumn>, CommandError> {
    let methods = args.methods_or(&[Variant::LSCM, Variant::PAPER]);
    let counts = args.counts_or(&[3, 16]);
    let last = counts.last().copied().unwrap_or(16);
    let mut surface = Surface::new(&exhibit.name, &exhibit.model);
    let maps = methods.iter().enumerate().map(|(k, &method)| {
        let count = counts.get(k).copied().unwrap_or(last);
        Ok((method, surface.map(method, count)?))
    });
    let maps = maps.collect::<Result<Vec<(Variant, Map)>, CommandError>>()?;
    let view = args.view.or_else(|| maps.last().map(|(_, map)| map.view())).unwrap_or_default();
    let column = |(letter, (method, map)): (char, &(Variant, Map))| {
        let area = &map.quality.distortion;
        SheetColumn {
            head: vec![
                format!("({letter}) {}", exhibit.name),
                format!("{}, {}", method.name(), counted(map.cones, "cone", "cones")),
            ],
            panels: vec![
                map.model(ColourName::Checker, view, args.panel()),
                map.layout(ColourName::Checker),
                map.model(ColourName::Area, view, args.panel()),
                map.layout(ColourName::Area),
            ],
            foot: vec![
                format!("D {:.3}", area.area_mean),
                paper::figure_one(*method).map_or_else(String::new, |d| format!("the paper, on its model: {d:.3}")),
            ],
        }
    };
    Ok(('a'..).zip(&maps).map(column).collect())
}

/// Figure 4: two methods with several numbers of cones.
fn methods(args: &FigureArgs, exhibit: &Exhibit) -> Result<Vec<SheetColumn>, CommandError> {
    let methods = args.methods_or(&[Variant::PAPER, Variant::REUSING]);
    let printed = exhibit.stand.as_ref().map(Stand::counts);
    let counts = args.counts_or(&printed.unwrap_or_else(|| vec![8, 16]));
    let mut surface = Surface::new(&exhibit.name, &exhibit.model);
    let mut maps = Vec::new();
    for &method in &methods {
        for &count in &counts {
            maps.push((method, count, surface.map(method, count)?));
        }
    }
    let view = args.view.or_else(|| maps.last().map(|(.., map)| map.view())).unwrap_or_default();
    let column = |(letter, (method, count, map)): (char, &(Variant, usize, Map))| SheetColumn {
        head: vec![format!("({letter}) {}, {}", exhibit.name, counted(map.cones, "cone", "cones")), method.name()],
        panels: vec![
            map.model(ColourName::Factor, view, args.panel()),
            map.model(ColourName::Checker, view, args.panel()),
            map.layout(ColourName::Checker),
        ],
        foot: paper::beside(map, exhibit.stand.as_ref(), *method, *count),
    };
    Ok(('a'..).zip(&maps).map(column).collect())
}

/// Figure 5: one method on several surfaces.
fn surfaces(args: &FigureArgs, exhibits: &[Exhibit]) -> Result<Vec<SheetColumn>, CommandError> {
    let method = args.methods_or(&[Variant::PAPER])[0];
    let count = args.counts_or(&[16])[0];
    let column = |(letter, exhibit): (char, &Exhibit)| {
        let map = Surface::new(&exhibit.name, &exhibit.model).map(method, count)?;
        let view = args.view.unwrap_or_else(|| map.view());
        Ok(SheetColumn {
            head: vec![format!("({letter}) {}, {}", exhibit.name, counted(map.cones, "cone", "cones")), method.name()],
            panels: vec![map.model(ColourName::Checker, view, args.panel()), map.layout(ColourName::Checker)],
            foot: paper::beside(&map, exhibit.stand.as_ref(), method, count),
        })
    };
    ('a'..).zip(exhibits).map(column).collect()
}

/// The surface and its layout by the default method.
fn readme(args: &FigureArgs, exhibit: &Exhibit) -> Result<(Picture, Vec<Figured>), CommandError> {
    let map = Surface::new(&exhibit.name, &exhibit.model).map(Variant::REFINED, 16)?;
    let view = args.view.unwrap_or_else(|| map.view());
    let model = map.model(ColourName::Checker, view, [360, 600]);
    let layout = map.told_layout().fitted([590, 600]);
    let mut page = Picture::blank(model.width + layout.width, 600, crate::render::PAPER);
    page.place(&model, [0, 0]);
    page.place(&layout, [model.width, (600 - layout.height) / 2]);
    Ok((page, Vec::new()))
}

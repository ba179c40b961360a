//! `cones tree`: how the components of a field's sublevel or superlevel sets merge.

use crate::commands::persistence::{DirectionName, DomainField, FieldArgs, Places, explain, on};
use crate::commands::shared::non_negative;
use crate::error::CommandError;
use crate::input::{FieldScalar, Number, each};
use crate::output::{self, Files};
use crate::report::SCHEMA;
use crate::report::table::{columns, counted, thousands};
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;
use topo::{Kind, PersistenceOptions};

#[derive(Args, Debug)]
pub(crate) struct TreeArgs {
    #[command(flatten)]
    of: FieldArgs,
    /// Whether leaves are minima, maxima, or each in a tree of its own
    #[arg(long, value_enum, default_value_t = DirectionName::Both)]
    direction: DirectionName,
    /// Leave out branches that are no more persistent than this
    #[arg(long, value_name = "P", default_value_t = 0.0, value_parser = non_negative, allow_negative_numbers = true)]
    min_persistence: f64,
    /// Write all nodes: .csv or .json
    #[arg(short, long, value_name = "OUT")]
    output: Option<PathBuf>,
    /// Print JSON in place of the table
    #[arg(long)]
    json: bool,
}

/// Rows of the table for each tree.
const ROWS: usize = 10;

/// The report of `cones tree`. Its keys are stable.
#[derive(Debug, Serialize)]
struct TreeReport {
    schema: u32,
    path: String,
    vertices: usize,
    trees: Vec<Tree>,
}

#[derive(Debug, Serialize)]
struct Tree {
    /// What leaves are: minima or maxima.
    kind: &'static str,
    leaves: usize,
    /// Leaves by rising index, then saddles as they enter, then roots that are neither.
    nodes: Vec<TreeNode>,
}

#[derive(Debug, Serialize)]
struct TreeNode {
    vertex: usize,
    value: Number,
    /// The node towards the root, as a place among the nodes from 0; nothing for a root.
    parent: Option<usize>,
    /// How many vertices are in the component of a leaf's branch just before it ends; nothing for other nodes.
    size: Option<usize>,
}

pub(crate) fn run(args: &TreeArgs) -> Result<(), CommandError> {
    args.output.as_deref().map_or(Ok(""), |path| output::extension(path, &["csv", "json"]))?;
    let outputs: Vec<_> = args.output.as_deref().into_iter().collect();
    output::check(&args.of.files(), &outputs)?;
    output::check_json(args.json, &outputs)?;
    let subject = DomainField::read(&args.of)?;
    let tree = |&kind: &Kind| Tree::new(&subject, kind, args.of.options(), args.min_persistence);
    let trees: Result<Vec<Tree>, topo::Error> = args.direction.kinds().iter().map(tree).collect();
    let trees = trees.map_err(|error| explain(&subject.path, error))?;
    let path = args.of.input.display().to_string();
    let report = TreeReport { schema: SCHEMA, path, vertices: subject.vertex_count(), trees };
    if let Some(path) = &args.output {
        let mut files = Files::new();
        match output::extension(path, &["csv", "json"])? {
            "csv" => files.write_csv(path, &report.rows(&subject.places))?,
            _ => files.write_json(path, &report)?,
        }
        files.finish()?;
    }
    if args.json { output::print_json(&report) } else { output::print_table(&report.text(&subject.places)) }
}

impl Tree {
    fn new(
        subject: &DomainField,
        kind: Kind,
        options: PersistenceOptions,
        threshold: f64,
    ) -> Result<Self, topo::Error> {
        fn told<S: FieldScalar>(kind: Kind, tree: &topo::MergeTree<usize, S>, threshold: f64) -> Tree {
            let tree = tree.simplify(S::threshold(threshold));
            let sizes: Vec<usize> = tree.branches().iter().map(|branch| branch.size).collect();
            let node = |(place, node): (usize, &topo::Node<usize, S>)| TreeNode {
                vertex: node.vertex,
                value: node.value.number(),
                parent: node.parent,
                size: sizes.get(place).copied(),
            };
            let nodes = tree.nodes().iter().enumerate().map(node).collect();
            Tree { kind: kind.name(), leaves: tree.leaf_count(), nodes }
        }
        each!(&subject.values, field => on!(&subject.domain, domain => {
            Ok(told(kind, &options.merge_tree(domain, field, kind)?, threshold))
        }))
    }

    /// Its leaves by the sizes of their branches, the largest first.
    fn largest(&self) -> Vec<usize> {
        let mut leaves: Vec<usize> = (0..self.leaves).collect();
        leaves.sort_by_key(|&leaf| std::cmp::Reverse(self.nodes[leaf].size));
        leaves
    }
}

impl TreeReport {
    fn text(&self, places: &Places) -> String {
        let mut text = String::new();
        for tree in &self.trees {
            let roots = tree.nodes.iter().filter(|node| node.parent.is_none()).count();
            let saddles = tree.nodes.len() - tree.leaves - if tree.nodes.len() > tree.leaves { roots } else { 0 };
            text += &format!(
                "{}: tree of {}, {}, {}\n\n",
                tree.kind,
                counted(tree.leaves, "leaf", "leaves"),
                counted(saddles, "saddle", "saddles"),
                counted(roots, "root", "roots")
            );
            let mut rows =
                vec![["leaf", places.head(), "value", "joins at", "value there", "size"].map(str::to_owned).to_vec()];
            for leaf in tree.largest().into_iter().take(ROWS) {
                let node = &tree.nodes[leaf];
                let parent = node.parent.map(|parent| &tree.nodes[parent]);
                rows.push(vec![
                    node.vertex.to_string(),
                    places.told(node.vertex),
                    node.value.short(),
                    parent.map_or_else(|| "–".to_owned(), |parent| places.short(parent.vertex)),
                    parent.map_or_else(|| "–".to_owned(), |parent| parent.value.short()),
                    node.size.map_or_else(String::new, thousands),
                ]);
            }
            text += &columns(&rows);
            if tree.leaves > ROWS {
                text += &format!("… and {} smaller; -o gives all\n", thousands(tree.leaves - ROWS));
            }
            text.push('\n');
        }
        text
    }

    /// All nodes as rows of a table under a head.
    fn rows(&self, places: &Places) -> Vec<Vec<String>> {
        let head = ["kind", "node", "vertex", "value", "parent", "size", "place"].map(str::to_owned).to_vec();
        let number = |number: Option<usize>| number.map_or_else(String::new, |number| number.to_string());
        let row = |tree: &Tree, (place, node): (usize, &TreeNode)| {
            let place = place.to_string();
            let told = places.told(node.vertex);
            let value = node.value.to_string();
            vec![
                tree.kind.to_owned(),
                place,
                node.vertex.to_string(),
                value,
                number(node.parent),
                number(node.size),
                told,
            ]
        };
        let rows = self.trees.iter().flat_map(|tree| tree.nodes.iter().enumerate().map(move |node| row(tree, node)));
        std::iter::once(head).chain(rows).collect()
    }
}

//! `cones view`: a surface and its maps, or a field, in the browser, served to this machine alone until the command is interrupted.

mod browser;
mod field;
mod guard;
mod http;
mod question;
mod session;
mod tabs;

use crate::commands::persistence::NanName;
use crate::commands::shared::{CandidateArgs, Chosen, Subject, warn};
use crate::error::CommandError;
use crate::input::{self, Layer, Source};
use crate::limits;
use crate::output;
use crate::progress::Progress;
use clap::Args;
use cones::{Analysis, ConeChoice, Options, RefinedModel};
use geom::io::refine_obj;
use guard::Guard;
use http::{Request, Response};
use session::Session;
use std::net::{Ipv4Addr, TcpListener};
use std::path::PathBuf;

#[derive(Args, Debug)]
pub(crate) struct ViewArgs {
    /// The surface: OBJ, OFF, PLY, STL or glTF, gzipped or not; or a field, such as an array or a picture
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// The port to listen at, on this machine alone [default: any that is free]
    #[arg(long, value_name = "P", default_value_t = 0, hide_default_value = true)]
    port: u16,
    /// Print the page's address and open no browser
    #[arg(long)]
    no_open: bool,
    #[command(flatten, next_help_heading = "Cones of a surface")]
    candidates: CandidateArgs,
    /// Show these values on the mesh: phi, curvature, mean-curvature, height[:x|y|z], distance[:VERTEX], or a file .npy or .txt
    #[arg(long, value_name = "VALUES", value_parser = Source::parse, help_heading = "Fields")]
    field: Option<Source>,
    /// A network's edges (.csv with columns a, b) [default: X.edges.csv beside X.nodes.csv]
    #[arg(long, value_name = "FILE", help_heading = "Fields")]
    edges: Option<PathBuf>,
    /// Of an array of three axes, the last with 3 or 4 values: one of these, from 0, or `volume` for all as they are
    #[arg(long, value_name = "N|volume", value_parser = Layer::parse, help_heading = "Fields")]
    layer: Option<Layer>,
    /// What to do with NaN, and with values that a file calls no data
    #[arg(long, value_enum, default_value_t = NanName::Refuse, help_heading = "Fields")]
    nan: NanName,
}

pub(crate) fn run(args: &ViewArgs) -> Result<(), CommandError> {
    let listen = |source| CommandError::Listen { port: args.port, source };
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, args.port)).map_err(listen)?;
    let port = listener.local_addr().map_err(listen)?.port();
    let guard = Guard::new(port).ok_or(CommandError::Random)?;
    if field::is_asked(args) {
        let page = field::page(args)?;
        return serve(args, &listener, &guard, |path, request| field::answer(&page, path, request));
    }
    if let Some(option) = args.edges.as_ref().map(|_| "--edges").or(args.layer.map(|_| "--layer")) {
        return Err(CommandError::Misplaced { path: args.input.clone(), option, of: "a field" });
    }
    let options = args.candidates.options_for(&args.input);
    let progress = Progress::begin(&args.input.display().to_string());
    let (model, _) = input::read_model(&args.input)?;
    limits::check_memory(&args.input, model.vertex_count())?;
    let failed = |error| CommandError::Unwrap { path: args.input.clone(), error };
    let analysis = Analysis::observed(&model, options.preparation, progress.observer()).map_err(failed)?;
    progress.finish();
    warn(analysis.repairs(), analysis.notes(), analysis.topology().components);
    let model = match analysis.refined() {
        Some(RefinedModel { model: refined, face, added, .. }) => {
            refine_obj(&model, added, refined, face).unwrap_or_else(|| refined.clone())
        }
        None => model,
    };
    let chosen = Chosen::new(count(&options, &analysis).map_err(failed)?, options.placement, options.rule);
    let subject = Subject::new(&args.input, &model, analysis, options);
    let session = Session::new(subject, &chosen, rayon::current_num_threads())?;
    serve(args, &listener, &guard, |path, request| session.answer(path, request))
}

/// Says where the page is, opens it, and answers what it asks until the command is interrupted.
fn serve(
    args: &ViewArgs,
    listener: &TcpListener,
    guard: &Guard,
    answer: impl Fn(&str, &Request) -> Response + Sync,
) -> Result<(), CommandError> {
    let address = guard.address();
    output::print(&format!("{address}\n"))?;
    if !args.no_open && !browser::open(&address) {
        output::note("no browser could be opened: open the address above\n");
    }
    http::serve(listener, |request| match guard.admit(&request) {
        Ok(path) => answer(path, &request),
        Err(refusal) => refusal,
    });
    Ok(())
}

/// How many cones the page begins with; as many as the surface asks for where it is none.
fn count(options: &Options, analysis: &Analysis) -> Result<Option<usize>, cones::Error> {
    Ok(match &options.cones {
        ConeChoice::Automatic => None,
        ConeChoice::Count(count) => Some((*count).max(analysis.least_cones())),
        _ => Some(analysis.choose(options)?.len()),
    })
}

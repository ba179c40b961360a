//! `cones view`: a surface and its maps, or a field, in the browser, served to this machine alone until the command is interrupted.

mod browser;
mod field;
mod guard;
mod http;
mod maps;
mod question;
mod session;
mod tabs;

use crate::commands::persistence::FieldArgs;
use crate::commands::shared::{CandidateArgs, Chosen, Subject, refined_model, warn, whole};
use crate::error::CommandError;
use crate::input::read_model;
use crate::limits;
use crate::output::{self, Volume};
use crate::progress::Progress;
use clap::Args;
use cones::{Analysis, ConeChoice, Options};
use guard::Guard;
use http::{Request, Response};
use session::Session;
use std::net::{Ipv4Addr, TcpListener};

#[derive(Args, Debug)]
#[command(mut_arg("input", |input| input.value_name("IN").help(INPUT).help_heading(None::<&str>)))]
#[command(after_help = EXAMPLES)]
pub(crate) struct ViewArgs {
    /// The port to listen at, on this machine alone [default: any that is free]
    #[arg(long, value_name = "P", value_parser = whole::<u16>("number", 0..=usize::from(u16::MAX)), allow_negative_numbers = true, default_value_t = 0, hide_default_value = true)]
    port: u16,
    /// Print the page's address and open no browser
    #[arg(long)]
    no_open: bool,
    #[command(flatten, next_help_heading = "Cones of a surface")]
    candidates: CandidateArgs,
    #[command(flatten, next_help_heading = "Fields")]
    of: FieldArgs,
}

const EXAMPLES: &str = "\
Examples:
  cones view scan.ply -n 8
  cones view height.npy";

const INPUT: &str = "The surface: OBJ, OFF, PLY, STL or glTF, gzipped or not; or a field, as `persistence` takes it";

pub(crate) fn run(args: &ViewArgs) -> Result<(), CommandError> {
    let listen = |source| CommandError::Listen { port: args.port, source };
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, args.port)).map_err(listen)?;
    let port = listener.local_addr().map_err(listen)?.port();
    let guard = Guard::new(port).ok_or(CommandError::Random)?;
    if field::is_asked(args) {
        let page = field::page(args)?;
        return serve(args, &listener, &guard, |path, request| field::answer(&page, path, request));
    }
    let input = &args.of.input;
    if let Some(option) = args.of.first_given() {
        return Err(CommandError::Misplaced { path: input.clone(), option, of: "a field" });
    }
    let options = args.candidates.options_for(input);
    let progress = Progress::begin(&input.display().to_string());
    let (model, _) = read_model(input)?;
    let (model, split) = args.candidates.with_edges_split(model);
    limits::check_memory(input, model.vertex_count(), limits::UNWRAPPED)?;
    let failed = |error| CommandError::Unwrap { path: input.clone(), error };
    let analysis = Analysis::observed(&model, options.preparation, progress.observer()).map_err(failed)?;
    progress.finish();
    warn(analysis.repairs(), analysis.notes(), analysis.topology().components);
    split.iter().for_each(|line| output::warn(line));
    let model = refined_model(model, &analysis);
    let chosen = Chosen::new(count(&options, &analysis).map_err(failed)?, options.placement, options.rule);
    let subject = Subject::new(input, &model, analysis, options);
    let session = Session::new(subject, &chosen, rayon::current_num_threads())?;
    std::thread::scope(|scope| {
        if let Some(begun) = session.begin(&chosen) {
            scope.spawn(|| session.make(begun));
        }
        serve(args, &listener, &guard, |path, request| session.answer(path, request))
    })
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
    // Programs that run this read the address alone, from standard output.
    let is_opened = !args.no_open && browser::open(&address);
    if output::volume() != Volume::Quiet {
        let how = match is_opened {
            true => "The page should open in your browser: if not, open the address above there.",
            false => "Open the address above in a browser on this machine.",
        };
        output::note(&format!("{how} Ctrl-C stops serving it.\n"));
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

//! The command `cones`: reads the arguments, runs a subcommand, says what went wrong.
//!
//! Exit codes: 0 done, 1 the input cannot be used or the output not be written, 2 wrong arguments (clap's), 128 and the number of
//! a signal that ended it, as 130 after an interrupt.

mod args;
mod commands;
mod error;
mod input;
mod limits;
mod output;
mod page;
mod progress;
mod render;
mod report;
mod vtk;

use args::{Arguments, Subcommand};
use clap::CommandFactory;
use commands::{
    bake, compare, completions, demo, distance, extract, features, figure, islands, man, measure, pack, persistence,
    shape, simplify, tree, unwrap, view,
};
use error::CommandError;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = Arguments::of_this_run();
    output::speak(arguments.volume());
    output::end_cleanly_on_signals();
    limits::end_cleanly_at_limits();
    limits::start_threads(arguments.threads);
    match run(&arguments.command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if error.is_closed_pipe() => ExitCode::SUCCESS,
        Err(error) => {
            output::explain(&error);
            ExitCode::FAILURE
        }
    }
}

fn run(command: &Subcommand) -> Result<(), CommandError> {
    match command {
        Subcommand::Unwrap(args) => unwrap::run(args),
        Subcommand::Extract(args) => extract::run(args),
        Subcommand::Compare(args) => compare::run(args),
        Subcommand::Figure(args) => figure::run(args),
        Subcommand::Measure(args) => measure::run(args),
        Subcommand::Islands(args) => islands::run(args),
        Subcommand::Pack(args) => pack::run(args),
        Subcommand::Bake(args) => bake::run(args),
        Subcommand::Persistence(args) => persistence::run(args),
        Subcommand::Tree(args) => tree::run(args),
        Subcommand::Simplify(args) => simplify::run(args),
        Subcommand::Distance(args) => distance::run(args),
        Subcommand::Features(args) => features::run(args),
        Subcommand::Shape(args) => shape::run(args),
        Subcommand::View(args) => view::run(args),
        Subcommand::Demo(args) => demo::run(args),
        Subcommand::Completions(args) => completions::run(args, Arguments::command()),
        Subcommand::Man(args) => man::run(args, Arguments::command()),
    }
}

//! The command `cones`: reads the arguments, runs a subcommand, says what went wrong.
//!
//! Exit codes: 0 done, 1 the input cannot be used or the output not be written, 2 wrong arguments (clap's), 130
//! interrupted.

mod args;
mod compare;
mod cone_file;
mod demo;
mod extract;
mod failure;
mod features;
mod field;
mod hierarchy_file;
mod job;
mod limit;
mod measure;
mod output;
mod page;
mod persistence;
mod picture;
mod pool;
mod progress;
mod report;
mod shape;
mod table;
mod unwrap;

use args::{Arguments, Command};
use clap::Parser;
use failure::Failure;
use std::error::Error;
use std::io::{self, Write};
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    output::end_cleanly_on_interrupt();
    pool::make(arguments.threads);
    match run(&arguments.command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) if failure.is_closed_pipe() => ExitCode::SUCCESS,
        Err(failure) => {
            // There is nobody to tell when stderr is closed, too.
            let _ = write!(io::stderr(), "{}", explain(&failure));
            ExitCode::FAILURE
        }
    }
}

fn run(command: &Command) -> Result<(), Failure> {
    match command {
        Command::Unwrap(args) => unwrap::run(args),
        Command::Extract(args) => extract::run(args),
        Command::Compare(args) => compare::run(args),
        Command::Measure(args) => measure::run(args),
        Command::Persistence(args) => persistence::run(args),
        Command::Features(args) => features::run(args),
        Command::Shape(args) => shape::run(args),
        Command::Demo(args) => demo::run(args),
    }
}

/// The failure and what lies behind it, a line each.
fn explain(failure: &Failure) -> String {
    let mut text = format!("error: {failure}\n");
    let mut behind = failure.source();
    while let Some(error) = behind {
        text += &format!("  because {error}\n");
        behind = error.source();
    }
    text
}

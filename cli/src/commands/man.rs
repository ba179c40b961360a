//! `cones man`: manual pages, which say what `--help` says.

use crate::error::CommandError;
use crate::output;
use clap::{Args, Command};
use clap_mangen::Man;
use clap_mangen::roff::{Roff, roman};
use std::io;

#[derive(Args, Debug)]
pub(crate) struct ManArgs {
    /// Of which subcommand [default: of the command]; to read it: cones man unwrap | man -l -
    #[arg(value_name = "COMMAND")]
    command: Option<String>,
}

pub(crate) fn run(args: &ManArgs, mut command: Command) -> Result<(), CommandError> {
    command.build();
    let page = match &args.command {
        None => command,
        Some(name) => {
            let found = command.find_subcommand(name);
            found.ok_or_else(|| CommandError::NoSubcommand(name.clone()))?.clone()
        }
    };
    output::print_bytes(&rendered(page).map_err(CommandError::Stdout)?)
}

/// The page, whose synopsis is what `--help` says of the usage: clap's own lists all options, without their values.
fn rendered(mut command: Command) -> io::Result<Vec<u8>> {
    let usage = command.render_usage().to_string();
    let examples = command.get_after_help().map(ToString::to_string);
    let has_subcommands = command.has_subcommands();
    let has_version = command.get_version().is_some();
    let page = Man::new(command);
    let mut text = Vec::new();
    page.render_title(&mut text)?;
    page.render_name_section(&mut text)?;
    let mut synopsis = Roff::new();
    synopsis.control("SH", ["SYNOPSIS"]).text([roman(usage.trim_start_matches("Usage: "))]);
    synopsis.to_writer(&mut text)?;
    page.render_description_section(&mut text)?;
    page.render_options_section(&mut text)?;
    if has_subcommands {
        page.render_subcommands_section(&mut text)?;
    }
    if let Some(examples) = examples {
        let mut section = Roff::new();
        section.control("SH", ["EXAMPLES"]).control("nf", []);
        for example in examples.lines().skip(1) {
            section.text([roman(example.trim_start())]);
        }
        section.control("fi", []);
        section.to_writer(&mut text)?;
    }
    if has_version {
        page.render_version_section(&mut text)?;
    }
    Ok(text)
}

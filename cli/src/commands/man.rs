//! `cones man`: manual pages, which say what `--help` says.

use crate::error::CommandError;
use crate::output;
use clap::{Args, Command};
use clap_mangen::Man;

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
    let mut text = Vec::new();
    Man::new(page).render(&mut text).map_err(CommandError::Stdout)?;
    output::print_bytes(&text)
}

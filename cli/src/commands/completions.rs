//! `cones completions`: a script with which a shell completes the command line.

use crate::error::CommandError;
use crate::output;
use clap::Args;
use clap_complete::Shell;

#[derive(Args, Debug)]
pub(crate) struct CompletionsArgs {
    /// Which shell; for bash: cones completions bash > ~/.local/share/bash-completion/completions/cones
    #[arg(value_name = "SHELL", value_enum)]
    shell: Shell,
}

pub(crate) fn run(args: &CompletionsArgs, mut command: clap::Command) -> Result<(), CommandError> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut command, "cones", &mut script);
    output::print_bytes(&script)
}

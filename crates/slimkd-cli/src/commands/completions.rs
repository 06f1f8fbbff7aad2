//! `slimkd completions`: a script that teaches a shell to complete our options.

use crate::args::Cli;
use crate::failure::Failure;
use crate::ui;
use clap::{Args, CommandFactory};
use clap_complete::Shell;

const EXAMPLES: &str = "\
Examples:
  slimkd completions bash > ~/.local/share/bash-completion/completions/slimkd
  slimkd completions zsh > ~/.zfunc/_slimkd
  slimkd completions fish > ~/.config/fish/completions/slimkd.fish";

/// Arguments of `slimkd completions`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct CompletionsArgs {
    /// The shell
    #[arg(value_enum)]
    shell: Shell,
}

/// Prints the script.
pub(crate) fn run(args: &CompletionsArgs) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "slimkd", &mut script);
    ui::print(&String::from_utf8_lossy(&script))
}

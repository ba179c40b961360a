//! What several subcommands share.

mod choice;
mod numbers;
mod pack_args;
mod unwrapped;
mod warn;

pub(crate) use choice::CandidateArgs;
pub(crate) use numbers::{non_negative, vertex_count};
pub(crate) use pack_args::PackArgs;
pub(crate) use unwrapped::{Scale, Unwrapped, corner_uv};
pub(crate) use warn::warn;

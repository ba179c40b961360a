//! What several subcommands share.

mod choice;
mod hierarchy;
mod material_files;
mod numbers;
mod pack_args;
pub(crate) mod page_file;
mod picture_args;
mod seams;
mod shown;
mod surface_file;
mod texture;
mod textures;
mod unwrapped;
mod vtp_file;
mod warn;
mod welded;

pub(crate) use choice::CandidateArgs;
pub(crate) use hierarchy::{HIERARCHY_ENDINGS, write_hierarchy};
pub(crate) use material_files::{MaterialFiles, material_text};
pub(crate) use numbers::{non_negative, vertex_count, whole};
pub(crate) use pack_args::PackArgs;
pub(crate) use picture_args::{ColourName, ShotArgs};
pub(crate) use seams::SeamArgs;
pub(crate) use shown::{Chosen, Shown, Subject};
pub(crate) use surface_file::{FormatName, SurfaceFile, write_map};
pub(crate) use texture::{overlap, texture};
pub(crate) use textures::{Bake, MapTextures, listed};
pub(crate) use unwrapped::{CLOSED_ORDER, Scale, Unwrapped, corner_uv, refined_model};
pub(crate) use vtp_file::text as vtp_text;
pub(crate) use warn::warn;
pub(crate) use welded::{WeldArgs, split_vertices};

//! Pictures of an unwrapped surface: the model with checkerboard or distortion, seams and cones, and its layout in the plane.
//!
//! A small rasteriser of our own draws them, so that a picture needs no window system and is the same on every machine.

mod ambient_occlusion;
mod camera;
mod canvas;
mod checker;
mod colour;
mod layout;
mod layout_svg;
mod legend;
mod light;
mod model;
mod paint;
mod picture;
mod scene;
mod svg;
mod view;

pub(crate) use checker::Checker;
pub(crate) use colour::{Colour, INK, MAXIMUM, MINIMUM, PAPER, decode, encode, encode_hue, mix};
pub(crate) use layout::{draw as draw_layout, draw_bare as draw_bare_layout};
pub(crate) use layout_svg::draw as draw_layout_svg;
pub(crate) use model::{Shot, draw as draw_model};
pub(crate) use paint::Paint;
pub(crate) use picture::{Letters, Picture};
pub(crate) use scene::{Mark, Scene, extent};
pub(crate) use svg::{Anchor, Svg};
pub(crate) use view::View;

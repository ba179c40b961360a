//! The layout as SVG: a few shapes, whatever the number of triangles.

use super::colour::{CHECKER, Colour, INK, hex};
use super::layout::{colour_of, cone_copies, disc, overlapping, size, to_page};
use super::scene::Scene;
use std::fmt::Write;

/// Up to so many triangles their sides are drawn as well; more would be a grey fog and a large file.
const FINE: usize = 20_000;

/// The layout as an SVG document: checkerboard, triangles where they are few, outline, cones. What lies over something else
/// stands out: the outline is filled in that colour, and then in the checkerboard's where it winds an odd number of times.
pub(crate) fn draw(scene: &Scene) -> String {
    let (width, height) = size(scene);
    let point = |uv: [f64; 2]| {
        let [x, y, _] = to_page(uv, height);
        format!("{x:.2} {y:.2}")
    };
    let path = |outline: &[[f64; 2]]| {
        let points: Vec<String> = outline.iter().map(|&uv| point(uv)).collect();
        format!("M{}Z", points.join("L"))
    };
    let outline: String = scene.outline().iter().map(|o| path(o)).collect();
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\">\n{}\
         <path d=\"{outline}\" fill=\"url(#over)\"/>\n<path d=\"{outline}\" fill=\"url(#checker)\" fill-rule=\"evenodd\"/>\n",
        patterns(scene, height)
    );
    if scene.triangles.len() <= FINE {
        let sides: String = scene.uv.iter().map(|corners| path(corners)).collect();
        svg += &format!(
            "<path d=\"{sides}\" fill=\"none\" stroke=\"{}\" stroke-width=\".4\" opacity=\".35\"/>\n",
            hex(INK)
        );
    }
    svg += &format!(
        "<path d=\"{outline}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2.2\" stroke-linejoin=\"round\"/>\n",
        hex(INK)
    );
    let copies = cone_copies(scene);
    let disc = disc(scene, copies.len());
    for (uv, cone) in copies {
        let [x, y, _] = to_page(uv, height);
        let _ = writeln!(
            svg,
            "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{:.2}\" fill=\"{}\" stroke=\"#fff\" stroke-width=\"{:.2}\"><title>vertex {}</title></circle>",
            0.47 * disc,
            hex(colour_of(&cone)),
            0.13 * disc,
            cone.vertex
        );
    }
    svg + "</svg>\n"
}

/// Two by two squares, repeated: as they are, and where the layout lies over itself.
fn patterns(scene: &Scene, height: f64) -> String {
    let [x, y, _] = to_page([0.0, 0.0], height);
    let side = to_page([1.0 / f64::from(scene.checker().squares), 0.0], height)[0] - x;
    let tile = 2.0 * side;
    let pattern = |name: &str, [light, dark]: [Colour; 2]| {
        let (light, dark) = (hex(light), hex(dark));
        format!(
            "<pattern id=\"{name}\" patternUnits=\"userSpaceOnUse\" x=\"{x:.4}\" y=\"{y:.4}\" width=\"{tile:.4}\" height=\"{tile:.4}\">\
             <path fill=\"{light}\" d=\"M0 0h{tile:.4}v{tile:.4}H0z\"/>\
             <path fill=\"{dark}\" d=\"M0 0h{side:.4}v{side:.4}H0zM{side:.4} {side:.4}h{side:.4}v{side:.4}h-{side:.4}z\"/></pattern>\n"
        )
    };
    format!("<defs>{}{}</defs>\n", pattern("checker", CHECKER), pattern("over", CHECKER.map(overlapping)))
}

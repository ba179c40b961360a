//! The layout as SVG: a few shapes, whatever the number of triangles.

use super::chart::Chart;
use super::colour::{CHECKER, INK, hex};
use super::layout::{colour_of, cone_copies, size, to_page};
use std::fmt::Write;

/// Up to so many triangles their sides are drawn as well; more would be a grey fog and a large file.
const FINE: usize = 20_000;

/// The layout as an SVG document: checkerboard, triangles where they are few, outline, cones.
pub(crate) fn draw(chart: &Chart) -> String {
    let (width, height) = size(chart);
    let point = |uv: [f64; 2]| {
        let [x, y, _] = to_page(uv, height);
        format!("{x:.2} {y:.2}")
    };
    let path = |outline: &[[f64; 2]]| {
        let points: Vec<String> = outline.iter().map(|&uv| point(uv)).collect();
        format!("M{}Z", points.join("L"))
    };
    let outline: String = chart.outline().iter().map(|o| path(o)).collect();
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\">\n{}\
         <path d=\"{outline}\" fill=\"url(#checker)\"/>\n",
        pattern(chart, height)
    );
    if chart.triangles.len() <= FINE {
        let sides: String = chart.uv.iter().map(|corners| path(corners)).collect();
        svg += &format!(
            "<path d=\"{sides}\" fill=\"none\" stroke=\"{}\" stroke-width=\".4\" opacity=\".35\"/>\n",
            hex(INK)
        );
    }
    svg += &format!(
        "<path d=\"{outline}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2.2\" stroke-linejoin=\"round\"/>\n",
        hex(INK)
    );
    for (uv, cone) in cone_copies(chart) {
        let [x, y, _] = to_page(uv, height);
        let _ = writeln!(
            svg,
            "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"7\" fill=\"{}\" stroke=\"#fff\" stroke-width=\"2\"><title>vertex {}</title></circle>",
            hex(colour_of(&cone)),
            cone.vertex
        );
    }
    svg + "</svg>\n"
}

/// Two by two squares, repeated.
fn pattern(chart: &Chart, height: f64) -> String {
    let [x, y, _] = to_page([0.0, 0.0], height);
    let side = to_page([1.0 / f64::from(chart.checker().squares), 0.0], height)[0] - x;
    let [light, dark] = CHECKER.map(hex);
    let tile = 2.0 * side;
    format!(
        "<defs><pattern id=\"checker\" patternUnits=\"userSpaceOnUse\" x=\"{x}\" y=\"{y}\" width=\"{tile}\" height=\"{tile}\">\
         <path fill=\"{light}\" d=\"M0 0h{tile}v{tile}H0z\"/><path fill=\"{dark}\" d=\"M0 0h{side}v{side}H0zM{side} {side}h{side}v{side}h-{side}z\"/>\
         </pattern></defs>\n"
    )
}

//! The layout as SVG: a few shapes, whatever the number of triangles.

use super::colour::{CHECKER, Colour, INK, ISLANDS, hex};
use super::layout::{colour_of, cone_copies, disc, frame, legend, overlapping, size, tinted, to_page};
use super::paint::{Paint, Scale};
use super::scene::Scene;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Up to so many triangles their sides are drawn as well; more would be a grey fog and a large file.
const FINE: usize = 20_000;
/// The height of a scale with its marks, and its width.
const FOOT: f64 = 48.0;
const BAR: f64 = 320.0;

/// The layout as an SVG document: checkerboard, triangles where they are few, outline, cones. What lies over something else
/// stands out: the outline is filled in that colour, and then in the checkerboard's where it winds an odd number of times.
pub(crate) fn draw(scene: &Scene, paint: &Paint) -> String {
    let (width, height) = size(scene);
    let point = |uv: [f64; 2]| {
        let [x, y, _] = to_page(uv, height);
        format!("{x:.2} {y:.2}")
    };
    let path = |outline: &[[f64; 2]]| {
        let points: Vec<String> = outline.iter().map(|&uv| point(uv)).collect();
        format!("M{}Z", points.join("L"))
    };
    let (island, count) = scene.islands();
    let kinds = if count > 1 { ISLANDS.len() } else { 1 };
    let mut outlines = vec![String::new(); kinds];
    for (triangle, outline) in scene.outlines() {
        outlines[island[triangle] % kinds] += &path(&outline);
    }
    let fills: String = outlines.iter().enumerate().filter(|(_, outline)| !outline.is_empty()).map(|(k, outline)| {
        format!(
            "<path d=\"{outline}\" fill=\"url(#over{k})\"/>\n<path d=\"{outline}\" fill=\"url(#checker{k})\" fill-rule=\"evenodd\"/>\n"
        )
    }).collect();
    let outline = outlines.concat();
    let is_checker = matches!(paint, Paint::Checker);
    let coloured = (!is_checker).then(|| triangles_in_colours(scene, paint, &path));
    let foot = paint.scale().map_or(0.0, |_| FOOT);
    let total = height + foot;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {total}\" width=\"{width}\" height=\"{total}\">\n{}{}",
        patterns(scene, height, count),
        coloured.unwrap_or(fills)
    );
    if scene.triangles.len() <= FINE && is_checker {
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
    for [from, to] in frame(scene) {
        let _ = writeln!(svg, "<path d=\"M{}L{}\" stroke=\"{}\" opacity=\".5\"/>", point(from), point(to), hex(INK));
    }
    svg += &written_legend(scene, count, height);
    svg += &paint.scale().map_or_else(String::new, |scale| drawn_scale(scale, height));
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

/// The triangles as a path for each of a few colours. Each has a line of its own colour round it, or the page would shine through between.
fn triangles_in_colours(scene: &Scene, paint: &Paint, path: &impl Fn(&[[f64; 2]]) -> String) -> String {
    let brush = paint.brush(scene);
    let mut paths: BTreeMap<String, String> = BTreeMap::new();
    for (t, corners) in scene.uv.iter().enumerate() {
        *paths.entry(hex(brush(t, [1.0 / 3.0; 3]))).or_default() += &path(corners);
    }
    let fill =
        |(colour, path)| format!("<path d=\"{path}\" fill=\"{colour}\" stroke=\"{colour}\" stroke-width=\".6\"/>\n");
    paths.into_iter().map(fill).collect()
}

/// A scale of colours with its marks and its title.
fn drawn_scale(scale: &Scale, top: f64) -> String {
    const STOPS: usize = 64;
    let mut svg = String::from("<defs><linearGradient id=\"scale\">");
    for k in 0..=STOPS {
        let at = k as f64 / STOPS as f64;
        let _ = write!(svg, "<stop offset=\"{at:.4}\" stop-color=\"{}\"/>", hex(scale.colour(at)));
    }
    let _ = write!(
        svg,
        "</linearGradient></defs>\n<rect x=\"24\" y=\"{top}\" width=\"{BAR}\" height=\"14\" fill=\"url(#scale)\"/>\n<g font-family=\"sans-serif\" font-size=\"14\" fill=\"{}\">\n",
        hex(INK)
    );
    for (place, mark) in &scale.marks {
        // A letter is less than nine units wide: a long mark at the left end stays on the page.
        let x = (24.0 + place * BAR).max(4.5 * mark.len() as f64);
        let _ = writeln!(svg, "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{mark}</text>", top + 29.0);
    }
    let _ = writeln!(svg, "<text x=\"{:.1}\" y=\"{:.1}\">{}</text>\n</g>", 24.0 + BAR + 24.0, top + 12.0, scale.title);
    svg
}

/// A line of text below. Overlaps show in the picture itself, which does not know them.
fn written_legend(scene: &Scene, islands: usize, height: f64) -> String {
    let mut text = String::new();
    for entry in legend(scene, islands, false) {
        let colour = entry.colour.unwrap_or(INK);
        let mark = if entry.colour.is_some() { "■ " } else { "" };
        let _ = write!(text, "<tspan fill=\"{}\">{mark}</tspan><tspan>{}   </tspan>", hex(colour), entry.text);
    }
    format!(
        "<text x=\"24\" y=\"{}\" font-family=\"sans-serif\" font-size=\"18\" fill=\"{}\" xml:space=\"preserve\">{text}</text>\n",
        height - 22.0,
        hex(INK)
    )
}

/// Two by two squares, repeated, in the colours of islands: as they are, and where the layout lies over itself.
fn patterns(scene: &Scene, height: f64, islands: usize) -> String {
    let [x, y, _] = to_page([0.0, 0.0], height);
    let side = to_page([1.0 / f64::from(scene.checker().squares), 0.0], height)[0] - x;
    let tile = 2.0 * side;
    let pattern = |name: String, [light, dark]: [Colour; 2]| {
        let (light, dark) = (hex(light), hex(dark));
        format!(
            "<pattern id=\"{name}\" patternUnits=\"userSpaceOnUse\" x=\"{x:.4}\" y=\"{y:.4}\" width=\"{tile:.4}\" height=\"{tile:.4}\">\
             <path fill=\"{light}\" d=\"M0 0h{tile:.4}v{tile:.4}H0z\"/>\
             <path fill=\"{dark}\" d=\"M0 0h{side:.4}v{side:.4}H0zM{side:.4} {side:.4}h{side:.4}v{side:.4}h-{side:.4}z\"/></pattern>\n"
        )
    };
    let kinds = if islands > 1 { ISLANDS.len().min(islands) } else { 1 };
    let both = |k: usize| {
        let colours = CHECKER.map(|colour| tinted(colour, k, islands));
        pattern(format!("checker{k}"), colours) + &pattern(format!("over{k}"), colours.map(overlapping))
    };
    format!("<defs>{}</defs>\n", (0..kinds).map(both).collect::<String>())
}

//! The demo's page: its pictures side by side.

use std::fs::File;
use std::io::Read;
use std::path::Path;

/// The page's file name.
pub(crate) const NAME: &str = "index.html";

/// The page begins with it, which tells a demo's folder from others.
const MARK: &str = "<!doctype html><!-- cones demo -->\n";

/// One column on a phone, light or dark as the system is; a shape with its map is seen at once on a small screen.
const STYLE: &str = ":root{color-scheme:light dark}\
body{font:16px/1.5 system-ui,sans-serif;margin:2rem auto;padding:0 1rem;max-width:1100px}\
section{display:grid;grid-template-columns:3fr 2fr;gap:1rem;align-items:center;margin:3rem 0}\
h2,p{grid-column:1/-1;margin:0}img{width:100%;max-height:28rem;object-fit:contain;border-radius:.4rem}\
@media(max-width:700px){section{grid-template-columns:1fr}}";

/// A page that shows the model and the layout of each shape.
pub(crate) fn text(shapes: &[&str]) -> String {
    let section = |shape: &&str| {
        format!(
            "<section><h2>{shape}</h2><img src=\"{shape}.png\" alt=\"model\"><img src=\"{shape}-layout.png\" alt=\"layout\">\
             <p><a href=\"{shape}.obj\">{shape}.obj</a> · <a href=\"{shape}.json\">report</a></p></section>\n"
        )
    };
    let sections: String = shapes.iter().map(section).collect();
    format!(
        "{MARK}<meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"><title>cones demo</title><style>{STYLE}</style>\n<h1>Unwrapped by cones</h1>\n\
         <p>Blue: cones of positive curvature; red: of negative. Dark lines: seams. Layouts: packed into the square of their texture.</p>\n{sections}"
    )
}

/// Whether a demo wrote the folder.
pub(crate) fn is_ours(folder: &Path) -> bool {
    let mut start = vec![0; MARK.len()];
    File::open(folder.join(NAME)).and_then(|mut file| file.read_exact(&mut start)).is_ok() && start == MARK.as_bytes()
}

//! The model in space: checkerboard or other colours, seams, cones.

use super::ambient_occlusion;
use super::camera::Camera;
use super::canvas::{Canvas, ScreenPoint};
use super::colour::{Colour, INK, INSIDE, MAXIMUM, MINIMUM, PAPER, mix};
use super::legend::{Entry, strip};
use super::light::Light;
use super::paint::Paint;
use super::picture::Picture;
use super::scene::{Scene, face_normal};
use super::view::{self, View};
use geom::vector::{Vec3, dot, step, unit};

const WIDTH: usize = 1280;
const HEIGHT: usize = 1024;
/// Empty pixels left round the model.
const MARGIN: usize = 40;
/// Seams' width in pixels.
const SEAM: f64 = 3.6;
/// Cones' radius, of a model of unit size.
const CONE: f64 = 0.0125;
/// Two faces that meet at more than this angle's cosine are shaded as one smooth surface.
const SMOOTH: f64 = 0.77;
/// Seams are drawn this share nearer than they are, so that the surface they lie on does not hide them.
const LIFT: f64 = 2e-3;
/// More cones than these shrink, so as to leave the surface in sight.
const CROWD: f64 = 40.0;
/// but not below this share: of the 1240 extrema of a scan each is still seen as a ball, and together they cover a fifteenth of it.
const LEAST_CONE: f64 = 0.4;
/// The least width of a seam in pixels, in small pictures.
const LEAST_SEAM: f64 = 1.4;
/// The inside is told of where it is more than this share of what is painted: the rim of an open surface shows a little of it.
const NOTICED: f64 = 0.01;
/// The least width of a picture with a legend.
const LEAST_STRIP: usize = 560;

/// From where a picture is taken, and how large it is.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Shot {
    /// None: three quarters from the side and from above.
    pub(crate) view: Option<View>,
    /// Width and height in pixels; none: as much as the model asks for.
    pub(crate) size: Option<[usize; 2]>,
}

/// Draws the model, with a legend below where its colours need one. Where the inside of the surface is seen, that is told.
pub(crate) fn draw(scene: &Scene, paint: &Paint, shot: Shot) -> Picture {
    let legend = |inside: bool| {
        let entries = if inside { vec![Entry::new(Some(INSIDE), "inside of the surface")] } else { Vec::new() };
        (inside || paint.scale().is_some()).then_some(entries)
    };
    let Some([width, height]) = shot.size else {
        let (canvas, inside) = taken(scene, paint, shot.view, [WIDTH, HEIGHT]);
        let picture = canvas.develop_trimmed(MARGIN);
        return match legend(inside) {
            Some(entries) => picture.above(&strip(picture.width.max(LEAST_STRIP), paint.scale(), &entries), PAPER),
            None => picture,
        };
    };
    // The legend has its place within the size that is asked for.
    let (canvas, inside) = taken(scene, paint, shot.view, [width, height]);
    let Some(entries) = legend(inside) else { return canvas.develop() };
    let strip = strip(width, paint.scale(), &entries);
    let room = height.saturating_sub(strip.height).max(1);
    let (canvas, _) = taken(scene, paint, shot.view, [width, room]);
    let mut picture = Picture::blank(width, height, PAPER);
    picture.place(&canvas.develop(), [0, 0]);
    picture.place(&strip, [0, room]);
    picture
}

/// The model on a canvas of a size, and whether its inside is seen.
fn taken(scene: &Scene, paint: &Paint, view: Option<View>, [width, height]: [usize; 2]) -> (Canvas, bool) {
    let camera = view::camera(scene, view, width, height);
    let mut canvas = Canvas::new(width, height, PAPER);
    let places: Vec<ScreenPoint> = scene.points.iter().map(|&p| camera.place(p)).collect();
    let inside = draw_surface(&mut canvas, scene, &camera, &places, paint.brush(scene));
    draw_seams(&mut canvas, scene, &places, (SEAM * height as f64 / HEIGHT as f64).max(LEAST_SEAM));
    ambient_occlusion::darken(&mut canvas, camera.pixel());
    draw_cones(&mut canvas, scene, &camera, &places);
    (canvas, inside > NOTICED)
}

/// Draws the surface; the share of what is seen of it that is its inside.
fn draw_surface(
    canvas: &mut Canvas,
    scene: &Scene,
    camera: &Camera,
    places: &[ScreenPoint],
    colour: impl Fn(usize, [f64; 3]) -> Colour,
) -> f64 {
    let normals = corner_normals(scene);
    let mut draw = |f: usize| {
        let t = scene.triangles[f];
        let sights = t.map(|v| camera.sight(scene.points[v as usize]));
        let outside = dot(camera.turn(face_normal(scene, &t)), sights[0]) >= 0.0;
        let light: [Light; 3] = std::array::from_fn(|k| {
            let normal = camera.turn(normals[f][k]);
            Light::on(facing(normal, sights[k], outside), sights[k])
        });
        let mut samples = 0_usize;
        canvas.triangle(t.map(|v| places[v as usize]), |w| {
            samples += 1;
            let colour = colour(f, w);
            let colour = if outside { colour } else { mix(colour, INSIDE, 0.6) };
            Light::blend(&light, w).apply(colour)
        });
        (samples, outside)
    };
    let (mut all, mut inside) = (0, Vec::new());
    for f in front_to_back(scene, places) {
        let (samples, outside) = draw(f);
        all += samples;
        if !outside && samples > 0 {
            inside.push(f);
        }
    }
    // Drawn again, once all is there, only what nothing hides is painted.
    let seen: usize = inside.into_iter().map(|f| draw(f).0).sum();
    seen as f64 / all.max(1) as f64
}

/// The triangles, nearest first: then little is painted that is hidden later.
fn front_to_back(scene: &Scene, places: &[ScreenPoint]) -> Vec<usize> {
    let nearness = |f: usize| scene.triangles[f].map(|v| places[v as usize][2]).into_iter().fold(0.0, f64::max);
    let mut order: Vec<usize> = (0..scene.triangles.len()).collect();
    order.sort_by_cached_key(|&f| std::cmp::Reverse((nearness(f) * 1e6) as i64));
    order
}

/// The normal on the eye's side of the surface; one that leans away, as interpolated ones do, is bent back to the rim.
fn facing(normal: Vec3, sight: Vec3, outside: bool) -> Vec3 {
    let normal = if outside { normal } else { normal.map(|x| -x) };
    let towards = dot(normal, sight);
    if towards < 0.0 { unit(step(normal, -towards, sight)) } else { normal }
}

fn draw_seams(canvas: &mut Canvas, scene: &Scene, places: &[ScreenPoint], width: f64) {
    let lifted = |v: u32| {
        let [x, y, nearness] = places[v as usize];
        [x, y, nearness * (1.0 + LIFT)]
    };
    for side in scene.seams.iter().flat_map(|seam| seam.windows(2)) {
        canvas.line(lifted(side[0]), lifted(side[1]), width, INK);
    }
}

fn draw_cones(canvas: &mut Canvas, scene: &Scene, camera: &Camera, places: &[ScreenPoint]) {
    let crowd = (CROWD / scene.cones.len().max(1) as f64).sqrt().clamp(LEAST_CONE, 1.0);
    for cone in &scene.cones {
        let place = places[cone.vertex as usize];
        let colour: Colour = if cone.positive { MINIMUM } else { MAXIMUM };
        canvas.ball(place, CONE * crowd, camera.scale(place), |n| Light::on(n, [0.0, 0.0, 1.0]).apply(colour));
    }
}

/// For each corner the mean normal of the faces round its vertex that lie nearly in its own face's direction, weighted
/// by area: smooth surfaces look smooth and sharp edges stay sharp.
fn corner_normals(scene: &Scene) -> Vec<[Vec3; 3]> {
    let normals: Vec<Vec3> = scene.triangles.iter().map(|t| face_normal(scene, t)).collect();
    let (start, faces) = faces_round(scene);
    let mean = |f: usize, v: u32| {
        let own = unit(normals[f]);
        let round = &faces[start[v as usize] as usize..start[v as usize + 1] as usize];
        let alike = round.iter().map(|&g| normals[g as usize]).filter(|&n| dot(unit(n), own) > SMOOTH);
        unit(alike.fold(normals[f].map(|x| x * 1e-9), |sum, n| step(sum, 1.0, n)))
    };
    scene.triangles.iter().enumerate().map(|(f, t)| t.map(|v| mean(f, v))).collect()
}

/// The faces round each vertex: those of v are `faces[start[v]..start[v + 1]]`.
fn faces_round(scene: &Scene) -> (Vec<u32>, Vec<u32>) {
    let mut start = vec![0u32; scene.points.len() + 2];
    for &v in scene.triangles.iter().flatten() {
        start[v as usize + 2] += 1;
    }
    for v in 1..start.len() {
        start[v] += start[v - 1];
    }
    let mut faces = vec![0; 3 * scene.triangles.len()];
    for (f, t) in (0u32..).zip(&scene.triangles) {
        for &v in t {
            let next = &mut start[v as usize + 1];
            faces[*next as usize] = f;
            *next += 1;
        }
    }
    (start, faces)
}

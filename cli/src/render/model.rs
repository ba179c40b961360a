//! The model in space: checkerboard by texture coordinates, seams, cones.

use super::ambient_occlusion;
use super::camera::Camera;
use super::canvas::{Canvas, Picture, ScreenPoint};
use super::colour::{Colour, INK, INSIDE, MAXIMUM, MINIMUM, PAPER, mix};
use super::light::Light;
use super::scene::{Scene, face_normal};
use super::view;
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
/// Bands of colour from the least value to the greatest.
const BANDS: f64 = 15.0;

/// Draws the model three quarters from the side and from above.
pub(crate) fn draw(scene: &Scene) -> Picture {
    let checker = scene.checker();
    draw_coloured(scene, |f, w| checker.colour([0, 1].map(|i| (0..3).map(|k| w[k] * scene.uv[f][k][i]).sum())))
}

/// Draws the model coloured by the values at its vertices, which range from 0 to 1; grey where one is NaN.
pub(crate) fn draw_values(scene: &Scene, values: &[f64]) -> Picture {
    draw_coloured(scene, |f, w| value_colour((0..3).map(|k| w[k] * values[scene.triangles[f][k] as usize]).sum()))
}

/// Draws the model; `colour` is given a triangle and a place in it.
fn draw_coloured(scene: &Scene, colour: impl Fn(usize, [f64; 3]) -> Colour) -> Picture {
    let camera = view::camera(scene, WIDTH, HEIGHT);
    let mut canvas = Canvas::new(WIDTH, HEIGHT, PAPER);
    let places: Vec<ScreenPoint> = scene.points.iter().map(|&p| camera.place(p)).collect();
    draw_surface(&mut canvas, scene, &camera, &places, colour);
    draw_seams(&mut canvas, scene, &places);
    ambient_occlusion::darken(&mut canvas, camera.pixel());
    draw_cones(&mut canvas, scene, &camera, &places);
    canvas.develop_trimmed(MARGIN)
}

fn draw_surface(
    canvas: &mut Canvas,
    scene: &Scene,
    camera: &Camera,
    places: &[ScreenPoint],
    colour: impl Fn(usize, [f64; 3]) -> Colour,
) {
    let normals = corner_normals(scene);
    for f in front_to_back(scene, places) {
        let t = scene.triangles[f];
        let sights = t.map(|v| camera.sight(scene.points[v as usize]));
        let outside = dot(camera.turn(face_normal(scene, &t)), sights[0]) >= 0.0;
        let light: [Light; 3] = std::array::from_fn(|k| {
            let normal = camera.turn(normals[f][k]);
            Light::on(facing(normal, sights[k], outside), sights[k])
        });
        canvas.triangle(t.map(|v| places[v as usize]), |w| {
            let colour = colour(f, w);
            let colour = if outside { colour } else { mix(colour, INSIDE, 0.6) };
            Light::blend(&light, w).apply(colour)
        });
    }
}

/// From pale blue over white to pale red, in bands, so that marks and level lines stand out.
fn value_colour(value: f64) -> Colour {
    if value.is_nan() {
        return mix(PAPER, INK, 0.3);
    }
    let band = (BANDS * value.clamp(0.0, 1.0)).floor().min(BANDS - 1.0) / (BANDS - 1.0);
    let end = if band < 0.5 { MINIMUM } else { MAXIMUM };
    mix(PAPER, end, 0.62 * (2.0 * band - 1.0).abs())
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

fn draw_seams(canvas: &mut Canvas, scene: &Scene, places: &[ScreenPoint]) {
    let lifted = |v: u32| {
        let [x, y, nearness] = places[v as usize];
        [x, y, nearness * (1.0 + LIFT)]
    };
    for side in scene.seams.iter().flat_map(|seam| seam.windows(2)) {
        canvas.line(lifted(side[0]), lifted(side[1]), SEAM, INK);
    }
}

fn draw_cones(canvas: &mut Canvas, scene: &Scene, camera: &Camera, places: &[ScreenPoint]) {
    for cone in &scene.cones {
        let place = places[cone.vertex as usize];
        let colour: Colour = if cone.positive { MINIMUM } else { MAXIMUM };
        canvas.ball(place, CONE, camera.scale(place), |n| Light::on(n, [0.0, 0.0, 1.0]).apply(colour));
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

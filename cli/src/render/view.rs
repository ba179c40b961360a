//! From where a model is looked at: upright, from above at a corner of its box, or as is asked.

use super::camera::Camera;
use super::scene::{Scene, face_normal};
use geom::vector::{Vec3, cross, dot, step, sub, unit};
use std::collections::BTreeMap;

/// Degrees to the right of the front, in order of preference, and how many times as many cones must be seen from there as from those before:
/// a bust is not shown from behind for the sake of an ear.
const TURNS: [(f64, f64); 4] = [(32.0, 1.0), (-32.0, 1.0), (-148.0, 1.5), (148.0, 1.5)];
/// The height above the horizon for each length away.
const RISE: f64 = 0.42;
/// A cone is seen where the surface is turned to the eye by more than this cosine.
const SEEN: f64 = 0.15;

/// Of a surface with one side, seen from it, the area covers more than this share of its box.
const ONE_SIDED: f64 = 0.25;

/// A direction to look from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct View {
    /// Degrees to the right of the front.
    azimuth: f64,
    /// Degrees above the horizon.
    elevation: f64,
}

/// Directions by their names.
const NAMES: [(&str, View); 6] = [
    ("front", View { azimuth: 0.0, elevation: 0.0 }),
    ("right", View { azimuth: 90.0, elevation: 0.0 }),
    ("back", View { azimuth: 180.0, elevation: 0.0 }),
    ("left", View { azimuth: -90.0, elevation: 0.0 }),
    ("above", View { azimuth: 0.0, elevation: 90.0 }),
    ("below", View { azimuth: 0.0, elevation: -90.0 }),
];

impl View {
    /// A name, or two numbers of degrees with a comma between them.
    ///
    /// # Errors
    /// What would be understood, in words.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let text = match text {
            "top" => "above",
            "bottom" => "below",
            other => other,
        };
        if let Some((_, view)) = NAMES.iter().find(|(name, _)| *name == text) {
            return Ok(*view);
        }
        let degrees = |text: &str, most: f64| text.trim().parse().ok().filter(|x: &f64| x.abs() <= most);
        let numbers = text.split_once(',').map(|(a, e)| (degrees(a, 360.0), degrees(e, 90.0)));
        match numbers {
            Some((Some(azimuth), Some(elevation))) => Ok(Self { azimuth, elevation }),
            _ => Err(format!(
                "known are {}, and AZIMUTH,ELEVATION: degrees to the right of the front, to 360, and above the horizon, to 90",
                NAMES.map(|(name, _)| name).join(", ")
            )),
        }
    }
}

impl View {
    /// The corner from which most cones are seen: limbs and faces have many.
    pub(crate) fn best(scene: &Scene) -> Self {
        let axes = axes(&used(scene));
        let normals = cone_normals(scene);
        let corner = |azimuth| Self { azimuth, elevation: RISE.atan().to_degrees() };
        let seen = |view: Self| {
            let from = view.direction(axes);
            normals.iter().filter(|&&n| dot(unit(n), from) > SEEN).count() as f64
        };
        let mut best = corner(TURNS[0].0);
        let mut most = seen(best);
        for (turn, times) in TURNS {
            let other = corner(turn);
            if seen(other) > times * most {
                (best, most) = (other, seen(other));
            }
        }
        best
    }

    /// From the model to the eye.
    fn direction(self, (up, front, side): (Vec3, Vec3, Vec3)) -> Vec3 {
        let (sin, cos) = self.azimuth.to_radians().sin_cos();
        let (rise, level) = self.elevation.to_radians().sin_cos();
        step(step(front.map(|x| x * cos), sin, side).map(|x| x * level), rise, up)
    }
}

/// The camera that looks from where is asked, by default from the best corner.
pub(crate) fn camera(scene: &Scene, view: Option<View>, width: usize, height: usize) -> Camera {
    let view = view.unwrap_or_else(|| View::best(scene));
    let used = used(scene);
    let axes = axes(&used);
    // At right angles to the direction, so that there is an upwards from straight above, too.
    let upwards = View { elevation: view.elevation + 90.0, ..view };
    Camera::framing(&used, view.direction(axes), upwards.direction(axes), width, height)
}

/// The points of the surface.
fn used(scene: &Scene) -> Vec<Vec3> {
    scene.triangles.iter().flatten().map(|&v| scene.points[v as usize]).collect()
}

/// The surface's normals at the cones.
fn cone_normals(scene: &Scene) -> Vec<Vec3> {
    let mut normals: BTreeMap<u32, Vec3> = scene.cones.iter().map(|cone| (cone.vertex, [0.0; 3])).collect();
    for t in &scene.triangles {
        for v in t {
            if let Some(normal) = normals.get_mut(v) {
                *normal = step(*normal, 1.0, face_normal(scene, t));
            }
        }
    }
    normals.into_values().collect()
}

/// Up, front and right of a model, given the corners of its triangles: y is up and z in front as in most files, except in a landscape, which is wide in x and y
/// and has one side: a figure that holds out its arms is as thin.
fn axes(points: &[Vec3]) -> (Vec3, Vec3, Vec3) {
    let size = |i: usize| {
        let (low, high) = points.iter().fold((f64::MAX, f64::MIN), |(l, h), p| (l.min(p[i]), h.max(p[i])));
        high - low
    };
    let upwards: f64 = points.as_chunks().0.iter().map(|&[a, b, c]| 0.5 * cross(sub(b, a), sub(c, a))[2]).sum();
    let is_thin = size(2) < 0.5 * size(0).min(size(1));
    if is_thin && upwards.abs() > ONE_SIDED * size(0) * size(1) {
        ([0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0])
    } else {
        ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_named_or_given_in_degrees() {
        assert_eq!(View::parse("right"), Ok(View { azimuth: 90.0, elevation: 0.0 }));
        assert_eq!([View::parse("top"), View::parse("bottom")], ["above", "below"].map(View::parse));
        assert_eq!(View::parse("-30, 15"), Ok(View { azimuth: -30.0, elevation: 15.0 }));
        for wrong in ["", "under", "1", "1,2,3", "NaN,0", "0,91", "inf,0"] {
            assert!(View::parse(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_landscape_lies_and_a_figure_with_its_arms_out_stands() {
        let corners = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.5], [4.0, 4.0, 0.0], [0.0, 4.0, 0.5]];
        let sheet = [0, 1, 2, 0, 2, 3].map(|k| corners[k]);
        let back = sheet.map(|[x, y, z]| [x, y, z - 0.4]);
        let closed: Vec<Vec3> = sheet.into_iter().chain(back.into_iter().rev()).collect();
        assert_eq!(axes(&sheet).0, [0.0, 0.0, 1.0]);
        assert_eq!(axes(&closed).0, [0.0, 1.0, 0.0]);
    }

    #[test]
    fn a_model_stands_upright_and_turns_to_the_left_as_the_eye_goes_to_the_right() {
        let points = [[-1.0, -1.0, -1.0], [1.0, -1.0, 1.0], [1.0, 1.0, -1.0], [-1.0, 1.0, 1.0]];
        let triangles = vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
        let uv = vec![[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]; 4];
        let scene = Scene::new(&points, triangles, uv, vec![], vec![]);
        let at = |view: &str, p: [f64; 3]| camera(&scene, Some(View::parse(view).unwrap()), 100, 100).place(p);
        let (low, high, front) = ([0.5, 0.1, 0.5], [0.5, 0.9, 0.5], [0.5, 0.5, 0.9]);
        for view in ["front", "back", "left", "120,40"] {
            assert!(at(view, high)[1] < at(view, low)[1], "{view}");
        }
        assert!(at("right", front)[0] < 49.0 && at("left", front)[0] > 51.0);
        // From above the front is below.
        assert!(at("above", front)[1] > at("above", [0.5, 0.5, 0.1])[1]);
    }
}

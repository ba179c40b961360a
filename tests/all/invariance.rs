//! What must not matter: size, place, turning, the order of faces, being run again.

use cones::{Analysis, Atlas, ConeChoice, Options, Placement, SeamOptions, unwrap_model};
use geom::shapes::{self, Shape};
use tests::solids;

/// How far a map may be from similar to another one, relative to its extent, where the coordinates are rounded otherwise:
/// f64 keeps sixteen digits, and a move by 1e3 sizes before the scaling costs three of them.
const SIMILAR: f64 = 1e-8;
/// The same for positions: where bent triangles are relaxed (on the bumpy sphere) the minimum is found to 4e-8; without relaxing 1e-8 holds.
const SIMILAR_MAP: f64 = 1e-7;

fn eight_cones() -> Options {
    Options { cones: ConeChoice::Count(8), ..Options::default() }
}

fn unwrapped(shape: &Shape, placement: Placement) -> Atlas {
    unwrapped_with(shape, &Options { placement, ..eight_cones() })
}

fn unwrapped_with(shape: &Shape, options: &Options) -> Atlas {
    unwrap_model(&solids::model(shape).expect("an ordinary shape"), options).expect("it unwraps")
}

fn vertices(atlas: &Atlas) -> Vec<u32> {
    atlas.cones.iter().map(|cone| cone.vertex).collect()
}

/// The largest distance of a corner from where the similarity that fits best takes it, relative to the extent.
fn difference(from: &[[f64; 2]], to: &[[f64; 2]]) -> f64 {
    let centre = |uv: &[[f64; 2]]| [0, 1].map(|k| uv.iter().map(|p| p[k]).sum::<f64>() / uv.len() as f64);
    let (c, d) = (centre(from), centre(to));
    let centred = || from.iter().zip(to).map(|(p, q)| ([p[0] - c[0], p[1] - c[1]], [q[0] - d[0], q[1] - d[1]]));
    let square: f64 = centred().map(|(p, _)| p[0] * p[0] + p[1] * p[1]).sum();
    let re = centred().map(|(p, q)| p[0] * q[0] + p[1] * q[1]).sum::<f64>() / square;
    let im = centred().map(|(p, q)| p[0] * q[1] - p[1] * q[0]).sum::<f64>() / square;
    let off = centred().map(|(p, q)| (re * p[0] - im * p[1] - q[0]).hypot(im * p[0] + re * p[1] - q[1]));
    let extent = centred().map(|(_, q)| q[0].hypot(q[1])).fold(0.0, f64::max);
    off.fold(0.0, f64::max) / extent
}

/// A closed and a bordered shape without symmetries, so that no tie is broken by rounding.
fn shapes_without_symmetry() -> [Shape; 3] {
    [solids::bumpy_sphere(4), shapes::terrain(1500, 5), bent(&solids::torus(24, 12))]
}

fn bent(shape: &Shape) -> Shape {
    solids::mapped(shape, |[x, y, z]| [x + 0.2 * y * y + 0.1 * z, y * (1.3 + 0.3 * x), z * (1.0 - 0.2 * y) + 0.1 * x])
}

/// Where seams prefer hidden places they are seen from directions that do not turn with the model, so a turned one has seams at their shortest.
#[test]
fn size_place_and_turning_change_neither_cones_nor_the_map() {
    for (angle, seams) in [(0.0, SeamOptions::default()), (0.7, SeamOptions { weight: 0.0, ..SeamOptions::default() })]
    {
        let (sin, cos) = f64::sin_cos(angle);
        let options = |placement| Options { placement, seams: seams.clone(), ..eight_cones() };
        for shape in shapes_without_symmetry() {
            for placement in [Placement::Persistence, Placement::Alternating, Placement::Refined] {
                let plain = unwrapped_with(&shape, &options(placement));
                for size in [1e-12, 1e-2, 3.0, 1e12] {
                    let moved = solids::mapped(&shape, |[x, y, z]| {
                        let [x, y] = [cos * x - sin * y, sin * x + cos * y];
                        let [y, z] = [cos * y - sin * z, sin * y + cos * z];
                        [size * (x + 900.0), size * (y - 500.0), size * (z + 20.0)]
                    });
                    let other = unwrapped_with(&moved, &options(placement));
                    assert_eq!(vertices(&other), vertices(&plain), "the same cones at size {size}");
                    for (a, b) in other.cones.iter().zip(&plain.cones) {
                        assert!((a.curvature - b.curvature).abs() < SIMILAR);
                    }
                    let off = difference(&plain.uv, &other.uv);
                    assert!(off < SIMILAR_MAP, "at size {size}, turned by {angle}, the map is off by {off:e}");
                }
            }
        }
    }
}

/// Coordinates near 1e7 have lost seven of their sixteen digits; the map is as good as what is left.
#[test]
fn a_place_far_away_costs_only_the_digits_that_coordinates_lose() {
    for shape in shapes_without_symmetry() {
        let plain = unwrapped(&shape, Placement::Refined);
        let far = solids::mapped(&shape, |[x, y, z]| [x + 1e7, y - 1e7, z + 1e7]);
        let other = unwrapped(&far, Placement::Refined);
        assert_eq!(vertices(&other), vertices(&plain), "the same cones");
        let off = difference(&plain.uv, &other.uv);
        assert!(off < 1e-4, "the map is off by {off:e}");
    }
}

#[test]
fn the_order_of_faces_and_their_corners_does_not_matter() {
    for shape in shapes_without_symmetry() {
        let plain = unwrapped(&shape, Placement::Persistence);
        let count = shape.triangles.len();
        // A step without common divisor goes through all of them.
        let step = (count / 3..).find(|&step| gcd(step, count) == 1).expect("a prime");
        let order: Vec<usize> = (0..count).map(|k| (k * step + 5) % count).collect();
        let turned = |&f: &usize| {
            let mut t = shape.triangles[f];
            t.rotate_left(f % 3);
            t
        };
        let shuffled = Shape { points: shape.points.clone(), triangles: order.iter().map(turned).collect() };
        let other = unwrapped(&shuffled, Placement::Persistence);
        assert_eq!(vertices(&other), vertices(&plain));
        let corner = |k: usize| [0, 1, 2].map(|j| other.uv[3 * k + (j + 3 - order[k] % 3) % 3]);
        let mut back = vec![[0.0; 2]; 3 * count];
        (0..count).for_each(|k| back[3 * order[k]..3 * order[k] + 3].copy_from_slice(&corner(k)));
        let off = difference(&plain.uv, &back);
        assert!(off < SIMILAR, "the map is off by {off:e}");
    }
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[test]
fn the_same_input_gives_the_same_bits() {
    for shape in shapes_without_symmetry() {
        let [first, second] = [0, 1].map(|_| unwrapped(&shape, Placement::Persistence));
        assert_eq!(first.uv, second.uv);
        assert_eq!(first.cones, second.cones);
        assert_eq!(first.seams, second.seams);
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let all =
        solids::side_by_side(&[shapes::hare(700), shapes::torus(1, 500), shapes::terrain(400, 3), shapes::square(100)]);
    let model = solids::model(&all).expect("an ordinary shape");
    for cones in [ConeChoice::Count(14), ConeChoice::Automatic] {
        let options = Options { cones, ..Options::default() };
        let [one, many] = [1, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a few threads");
            pool.install(|| unwrap_model(&model, &options).expect("it unwraps"))
        });
        let with_cones = |component| one.cones.iter().any(|cone| cone.component == component);
        assert_eq!([0, 1, 2, 3].map(with_cones), [true, true, true, false], "all parts but the flat one get cones");
        let bits = |atlas: &Atlas| atlas.uv.iter().flatten().map(|x| x.to_bits()).collect::<Vec<u64>>();
        assert!(bits(&one) == bits(&many));
        assert_eq!((one.cones, one.number, one.seams), (many.cones, many.number, many.seams));
        assert_eq!(one.notes, many.notes);
    }
}

#[test]
fn any_number_of_threads_finds_the_same_cones_on_surfaces_with_coarse_levels() {
    let all = solids::side_by_side(&[shapes::hare(8500), shapes::torus(1, 8300), shapes::terrain(400, 3)]);
    let model = solids::model(&all).expect("an ordinary shape");
    let found = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a few threads");
        pool.install(|| {
            let analysis = Analysis::new(&model).expect("it is analysed");
            let found = |cones| analysis.choose(&Options { cones, ..Options::default() }).expect("there are cones");
            let [asked, chosen] = [ConeChoice::Count(12), ConeChoice::Automatic].map(found);
            let preview = analysis.preview(20).expect("nobody says stop");
            (asked.as_slice().to_vec(), chosen.as_slice().to_vec(), chosen.number().cloned(), preview)
        })
    });
    assert!(found[0] == found[1]);
}

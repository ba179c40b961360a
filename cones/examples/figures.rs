//! The norms of the log scale factor that `refined` and `pursuit` reach on a folder of meshes, beside those of a trial
//! implementation that they must not fall behind.
//!
//! `cargo run --release -p cones --example figures -- FOLDER [WORD…]`, only meshes whose names contain one of the words

use cones::{Analysis, CurvatureRule, Placement};
use std::error::Error;
use std::path::Path;
use std::time::Instant;

/// A mesh, and for numbers of cones the norm to reach.
type Row = (&'static str, &'static [(usize, f64)]);

/// Closed surfaces, over which means are taken.
const MESHES: [Row; 10] = [
    ("spot_2930.obj", &[(4, 0.529), (8, 0.352), (16, 0.184), (32, 0.102)]),
    ("table1/fandisk_6475.obj", &[(4, 0.194), (8, 0.121), (16, 0.082), (32, 0.036)]),
    ("table1/planck_10000.obj", &[(4, 0.185), (8, 0.125), (16, 0.077), (32, 0.049)]),
    ("table1/moai_10002.obj", &[(4, 0.168), (8, 0.089), (16, 0.060), (32, 0.035)]),
    ("table1/octaflower_7994.obj", &[(4, 0.231), (8, 0.060), (16, 0.046), (32, 0.039)]),
    ("rocker_arm_10044.obj", &[(4, 0.271), (8, 0.164), (16, 0.097), (32, 0.065)]),
    ("bunny_14290.obj", &[(4, 0.475), (8, 0.251), (16, 0.127), (32, 0.081)]),
    ("table1/fandisk_25994.obj", &[(4, 0.193), (8, 0.118), (16, 0.079), (32, 0.035)]),
    ("table1_resized/igea_33587.obj", &[(4, 0.182), (8, 0.099), (16, 0.059), (32, 0.039)]),
    ("table1/rabbit_46646.obj", &[(4, 0.474), (8, 0.250), (16, 0.125), (32, 0.080)]),
];

/// Surfaces of higher genus and with boundaries.
const OTHERS: [Row; 10] = [
    ("fertility_4494.off", &[(16, 0.148)]),
    ("threeholes_3596.off", &[(16, 0.119)]),
    ("casting_5096.obj", &[(16, 0.184)]),
    ("hemisphere_2051.obj", &[(1, 0.0945), (2, 0.0746), (4, 0.0468), (8, 0.0291), (16, 0.0176), (32, 0.0104)]),
    ("punctured_torus_4599.obj", &[(1, 0.288), (2, 0.254), (4, 0.188), (8, 0.105), (16, 0.0586), (32, 0.0360)]),
    ("camelhead_11381.off", &[(1, 0.825), (2, 0.539), (4, 0.253), (8, 0.135), (16, 0.0904), (32, 0.0483)]),
    ("table1/planck_open_10064.obj", &[(1, 0.535), (2, 0.253), (4, 0.165), (8, 0.118), (16, 0.0746), (32, 0.0515)]),
    ("face_17157.obj", &[(1, 0.449), (2, 0.400), (4, 0.309), (8, 0.160), (16, 0.0949), (32, 0.0591)]),
    ("beetle_19887.off", &[(1, 0.0348), (2, 0.0297), (4, 0.0247), (8, 0.0199), (16, 0.0146), (32, 0.0105)]),
    ("bunny_zipper_35947.obj", &[(1, 0.989), (2, 0.493), (4, 0.294), (8, 0.222), (16, 0.122), (32, 0.0786)]),
];

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().ok_or("which folder?")?;
    let words: Vec<String> = arguments.collect();
    let is_asked = |name: &str| words.is_empty() || words.iter().any(|word| name.contains(word.as_str()));
    for rows in [&MESHES, &OTHERS] {
        let mut ratios = Vec::new();
        for (name, figures) in rows.iter().filter(|(name, _)| is_asked(name)) {
            ratios.extend(measure(&Path::new(&folder).join(name), figures)?);
        }
        let mean = |of: usize| (ratios.iter().map(|r| r[of].ln()).sum::<f64>() / ratios.len() as f64).exp();
        let most = ratios.iter().map(|r| r[0]).fold(0.0, f64::max);
        println!("geometric means: refined {:.4} (at most {most:.3}), pursuit {:.4} of the figures", mean(0), mean(1));
    }
    Ok(())
}

/// Prints a line for each number of cones; returns what `refined` and `pursuit` reach as shares of the figures.
fn measure(path: &Path, figures: &[(usize, f64)]) -> Result<Vec<[f64; 2]>, Box<dyn Error>> {
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let analysis = Analysis::new(&geom::io::read(path)?)?;
    let start = Instant::now();
    let order = analysis.order(Placement::Pursuit, CurvatureRule::Optimal, 32)?;
    println!("{name:22} pursuit of 64: {:.2} s", start.elapsed().as_secs_f64());
    let mut ratios = Vec::new();
    for &(count, figure) in figures {
        let start = Instant::now();
        let best = analysis.place(Placement::Refined, count)?.prediction().log_scale_norm;
        let time = start.elapsed().as_secs_f64();
        let nested = order.curve.iter().find(|point| point.count == count).map_or(f64::NAN, |p| p.log_scale_norm);
        let ratio = [best / figure, nested / figure];
        println!(
            "{name:22} {count:3} cones: {best:.4}, {:.3} of {figure} (pursuit {:.3}); {time:.2} s",
            ratio[0], ratio[1]
        );
        ratios.push(ratio);
    }
    Ok(ratios)
}

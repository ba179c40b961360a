use super::*;
use crate::shapes::{self, Shape};

#[test]
fn dump() {
    use std::io::Write;
    let mut s = 1u64;
    let mut rnd = move || {
        s = s.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (s >> 33) as f64 / (1u64 << 31) as f64
    };
    type Uv = Vec<[[f64; 2]; 3]>;
    let mut cases: Vec<(String, Shape, Uv)> = vec![];
    let project = |s: &Shape, f: &dyn Fn([f64; 3]) -> [f64; 2]| -> Uv {
        s.triangles.iter().map(|t| t.map(|v| f(s.points[v as usize]))).collect()
    };
    let n: usize = std::env::var("N").ok().and_then(|n| n.parse().ok()).unwrap_or(3000);
    for name in ["sphere", "disk", "cylinder", "terrain"] {
        let sh = shapes::by_name(name, n).unwrap();
        let uv = project(&sh, &|p| [p[0] + 0.3 * p[2], p[1] + 0.1 * p[2]]);
        cases.push((format!("{name}-planar"), sh.clone(), uv));
        // angle round z with a cut, and height
        let uv = sh
            .triangles
            .iter()
            .map(|t| {
                let a = t.map(|v| {
                    let p = sh.points[v as usize];
                    p[1].atan2(p[0])
                });
                let hi = a.iter().any(|&x| x > 1.8);
                [0, 1, 2].map(|k| {
                    let p = sh.points[t[k] as usize];
                    [if hi && a[k] < -1.2 { a[k] + 2.0 * PI } else { a[k] }, 1.3 * p[2] + 0.2 * (p[0].hypot(p[1]))]
                })
            })
            .collect();
        cases.push((format!("{name}-round"), sh.clone(), uv));
        // triangles each on its own
        let uv = sh.triangles.iter().map(|_| [0; 3].map(|_| [rnd(), rnd()])).collect();
        cases.push((format!("{name}-soup"), sh.clone(), uv));
        // stereographic
        let uv = project(&sh, &|p| {
            let l = crate::vector::length(p);
            let p = p.map(|x| x / l);
            [-p[0] / (1.3 - p[2]), p[1] / (1.3 - p[2])]
        });
        cases.push((format!("{name}-stereo"), sh.clone(), uv));
        // hurt: turned, doubled, degenerate, collapsed
        let mut sh2 = sh.clone();
        let mut uv = project(&sh, &|p| [p[0], p[1]]);
        for (f, t) in sh2.triangles.iter_mut().enumerate() {
            if f % 7 == 0 {
                t.swap(0, 1);
                uv[f].swap(0, 1);
            }
            if f % 31 == 0 {
                uv[f] = [uv[f][0]; 3];
            }
            if f % 57 == 0 {
                t[1] = t[0];
                uv[f][1] = uv[f][0];
            }
        }
        for f in 0..0 {
            let t = sh2.triangles[f * 9];
            sh2.triangles.push(t);
            let q = uv[f * 9];
            uv.push(q.map(|q| [q[0] + 1.0, q[1]]));
        }
        cases.push((format!("{name}-hurt"), sh2, uv));
    }
    for (name, sh, uv) in &cases {
        let cpu = || {
            std::fs::read_to_string("/proc/thread-self/schedstat")
                .unwrap()
                .split(' ')
                .next()
                .unwrap()
                .parse::<f64>()
                .unwrap()
                / 1e9
        };
        let c0 = cpu();
        let t = std::time::Instant::now();
        let d = measure(&sh.points, &sh.triangles, uv);
        let dt = std::time::Duration::from_secs_f64(cpu() - c0);
        let Ok(d) = d else {
            println!("MINE {{\"name\": \"{name}\", \"error\": \"{}\"}}", d.unwrap_err());
            continue;
        };
        let o = overlap(uv, 2048);
        let dto = t.elapsed() - dt;
        let chi: Vec<i64> = d.islands.iter().take(8).map(|i| i.euler_characteristic).collect();
        let loops: Vec<usize> = d.islands.iter().take(8).map(|i| i.boundary_loops).collect();
        let c = d.cones(0.1);
        println!(
            "MINE {{\"name\": \"{name}\", \"qc_mean\": {}, \"qc_med\": {}, \"qc_p95\": {}, \"qc_p99\": {}, \"qc_max\": {}, \"area_D\": {}, \"area_D_med\": {}, \"area_D_p95\": {}, \"area_D_p99\": {}, \"area_D_max\": {}, \"u_L2_c\": {}, \"u_Linf_c\": {}, \"flipped\": {}, \"degenerate_uv\": {}, \"degenerate_3d\": {}, \"islands\": {}, \"chi_uv\": {chi:?}, \"loops_uv\": {loops:?}, \"disk_islands\": {}, \"mirrored_islands\": {}, \"seam_edges\": {}, \"seam_rel\": {}, \"seam_mismatch\": {}, \"cone_verts\": {}, \"top\": {}, \"overlap\": {o}, \"t\": {}, \"to\": {}}}",
            d.quasi_conformal.mean,
            d.quasi_conformal.median,
            d.quasi_conformal.p95,
            d.quasi_conformal.p99,
            d.quasi_conformal.max,
            d.area.mean,
            d.area.median,
            d.area.p95,
            d.area.p99,
            d.area.max,
            d.u_l2,
            d.u_linf,
            d.flipped,
            d.degenerate,
            d.degenerate_on_surface,
            d.islands.len(),
            d.islands.iter().filter(|i| i.is_disk()).count(),
            d.islands.iter().filter(|i| i.is_mirrored).count(),
            d.seam_edges,
            d.seam_length,
            d.seam_mismatch,
            c.len(),
            c.first().map_or(0.0, |c| c.1),
            dt.as_secs_f64(),
            dto.as_secs_f64()
        );
        if n > 10000 {
            continue;
        }
        let mut f = std::io::BufWriter::new(std::fs::File::create(format!("/tmp/shapes_out/maps/{name}.obj")).unwrap());
        for p in &sh.points {
            writeln!(f, "v {} {} {}", p[0], p[1], p[2]).unwrap();
        }
        for q in uv.as_flattened() {
            writeln!(f, "vt {} {}", q[0], q[1]).unwrap();
        }
        for (k, t) in sh.triangles.iter().enumerate() {
            writeln!(f, "f {}/{} {}/{} {}/{}", t[0] + 1, 3 * k + 1, t[1] + 1, 3 * k + 2, t[2] + 1, 3 * k + 3).unwrap();
        }
    }
}

//! One measurement for `peers.py`: reads a field of `f64` and does one thing to it, several times.
//!
//! Arguments: what (behind the name of a connectivity if it is not `Full` for pictures, `Axis` for volumes), the lengths of the axes as in `1024x1024`, the file, how often. Prints the least mean seconds of
//! processor time of a call, and the bytes that the first one took beyond what was there. Without arguments, as `cargo bench` calls it, it does nothing.

use std::error::Error;
use std::fs::{self, File};
use std::io::{BufReader, Read};
use std::time::Instant;
use topo::{Connectivity, Grid, Kind, Path};

/// Seconds that calls are repeated for: processor time comes in steps of some milliseconds.
const LEAST: f64 = 0.25;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).filter(|arg| arg != "--bench").collect();
    let [what, shape, file, times] = &args[..] else { return Ok(()) };
    let shape: Vec<usize> = shape.split('x').map(str::parse).collect::<Result<_, _>>()?;
    // Little by little: a large buffer that is freed changes what the system's allocator does afterwards.
    let (mut file, mut field, mut number) =
        (BufReader::new(File::open(file)?), Vec::with_capacity(shape.iter().product()), [0; 8]);
    while field.len() < field.capacity() {
        file.read_exact(&mut number)?;
        field.push(f64::from_le_bytes(number));
    }
    let call = || once(what, &shape, &field);
    let before = resident("VmRSS")?;
    call()?;
    let taken = resident("VmHWM")?.saturating_sub(before);
    let mut best = f64::INFINITY;
    for _ in 0..times.parse()? {
        let (start, mut calls) = (Processor::now(), 0);
        while calls == 0 || start.elapsed() < LEAST {
            call()?;
            calls += 1;
        }
        best = best.min(start.elapsed() / f64::from(calls));
    }
    println!("{best} {taken}");
    Ok(())
}

/// Does a thing to the field and forgets the result.
fn once(what: &str, shape: &[usize], field: &[f64]) -> Result<(), Box<dyn Error>> {
    match *shape {
        [n] => drop(topo::sublevel(&Path::new(n), field)?),
        [h, w] if what == "pairs and holes" => {
            drop(topo::pairs_and_holes(&Grid::new([h, w], Connectivity::Full), field, Kind::Minimum)?);
        }
        [h, w] => {
            let (connectivity, what) = connectivity(what).unwrap_or((Connectivity::Full, what));
            on_grid(what, Grid::new([h, w], connectivity), field)?;
        }
        [d, h, w] => {
            let (connectivity, what) = connectivity(what).unwrap_or((Connectivity::Axis, what));
            on_grid(what, Grid::new([d, h, w], connectivity), field)?;
        }
        _ => return Err("one to three axes".into()),
    }
    Ok(())
}

/// The edges that are named first, and what is to be done.
fn connectivity(what: &str) -> Option<(Connectivity, &str)> {
    let (edges, what) = what.split_once(' ')?;
    let connectivity = match edges {
        "axis" => Connectivity::Axis,
        "full" => Connectivity::Full,
        "freudenthal" => Connectivity::Freudenthal,
        _ => return None,
    };
    Some((connectivity, what))
}

fn on_grid<const D: usize>(what: &str, grid: Grid<D>, field: &[f64]) -> Result<(), Box<dyn Error>>
where
    for<'a> &'a Grid<D>: topo::Domain<Vertex = usize>,
{
    match what {
        "pairs" => drop(topo::sublevel(&grid, field)?),
        "holes" => drop(topo::holes(&grid, field, Kind::Minimum)?),
        "tree" => drop(topo::merge_tree(&grid, field, Kind::Minimum)?),
        "segmentation" => drop(topo::segmentation(&grid, field, Kind::Minimum, 0.5)?),
        "contour tree" => drop(topo::contour_tree(&grid, field)?),
        "sort" => {
            let mut keys: Vec<(u64, u32)> =
                field.iter().zip(0..).map(|(value, v)| (topo::Scalar::key(*value).unwrap_or(0), v)).collect();
            keys.sort_unstable();
        }
        _ => return Err(format!("{what} is not measured").into()),
    }
    Ok(())
}

/// A line of what Linux tells of the memory of a process, in bytes.
fn resident(name: &str) -> Result<u64, Box<dyn Error>> {
    if name == "VmRSS" {
        // The peak from now on.
        fs::write("/proc/self/clear_refs", "5")?;
    }
    let text = fs::read_to_string("/proc/self/status")?;
    let line = text.lines().find_map(|line| line.strip_prefix(name)).ok_or("no such line")?;
    let kilobytes: u64 = line.trim_matches([':', ' ', '\t', 'k', 'B']).parse()?;
    Ok(1024 * kilobytes)
}

/// When something began: on the processor where the system tells, by the clock elsewhere.
struct Processor {
    seconds: Option<f64>,
    start: Instant,
}

impl Processor {
    fn now() -> Self {
        Self { seconds: on_processor(), start: Instant::now() }
    }

    fn elapsed(&self) -> f64 {
        let on_processor = on_processor().zip(self.seconds).map(|(now, then)| now - then);
        on_processor.unwrap_or_else(|| self.start.elapsed().as_secs_f64())
    }
}

fn on_processor() -> Option<f64> {
    let text = fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = text.split(' ').next()?.parse().ok()?;
    Some(1e-9 * nanoseconds)
}

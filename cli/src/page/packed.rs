//! Surfaces and maps in few bytes, for a file that holds many maps.
//!
//! Vertices are numbered anew in the order in which triangles name them, so that most corners of a triangle are "the next new
//! one" or one of those just before. A vertex's values, in 16 bits each, are told as differences from those of a vertex of the
//! same triangle that is known already. What is small then is left to deflate. The page undoes all of it (`web/src/packed.ts`).

/// Steps of a coordinate along the longest side.
const STEPS: f64 = 65_535.0;
/// What a byte for a log ratio of areas spans, to either side of 0: a factor of 400.
pub(crate) const MOST_LOG_AREA: f64 = 6.0;
/// What a byte for σ₁/σ₂ spans, as a logarithm: up to 20.
pub(crate) const MOST_LOG_STRETCH: f64 = 3.0;

/// How vertices are numbered, and from which other one each is told.
#[derive(Clone, Debug)]
pub(crate) struct Numbering {
    /// For each vertex as it is numbered here its number in the model.
    pub(crate) vertex: Vec<u32>,
    /// For each vertex of the model its number here; [`u32::MAX`] where no triangle has it.
    pub(crate) number: Vec<u32>,
    /// The vertex that each is told from; the first of a part itself.
    from: Vec<u32>,
}

impl Numbering {
    pub(crate) fn new(vertices: usize, triangles: &[[u32; 3]]) -> Self {
        let mut found = Self { vertex: Vec::new(), number: vec![u32::MAX; vertices], from: Vec::new() };
        for triangle in triangles {
            let mut known = triangle.iter().map(|&v| found.number[v as usize]).find(|&n| n != u32::MAX);
            for &v in triangle {
                if found.number[v as usize] == u32::MAX {
                    let next = found.vertex.len() as u32;
                    found.number[v as usize] = next;
                    found.from.push(*known.get_or_insert(next));
                    found.vertex.push(v);
                }
            }
        }
        found
    }

    /// Triangles of the model: how far each corner is before the next new vertex.
    pub(crate) fn triangles(&self, triangles: &[[u32; 3]]) -> Vec<u8> {
        let mut next = 0;
        let mut bytes = Vec::new();
        for &v in triangles.as_flattened() {
            let number = self.number[v as usize];
            push(&mut bytes, u64::from(next - number));
            next = next.max(number + 1);
        }
        bytes
    }

    /// Values of each vertex of the model, within a range that all share: differences, low bytes first, then high ones.
    pub(crate) fn values<const N: usize>(&self, range: Range<N>, value: impl Fn(u32) -> [f64; N]) -> Vec<u8> {
        let steps: Vec<[u16; N]> = self.vertex.iter().map(|&v| range.steps(value(v))).collect();
        let told = |(k, &from): (usize, &u32)| {
            let from = if from as usize == k { [0; N] } else { steps[from as usize] };
            std::array::from_fn(|i| folded(steps[k][i].wrapping_sub(from[i])))
        };
        let told: Vec<[u16; N]> = self.from.iter().enumerate().map(told).collect();
        let planes = told.as_flattened();
        planes.iter().map(|x| *x as u8).chain(planes.iter().map(|x| (x >> 8) as u8)).collect()
    }
}

/// The range of coordinates that are told in steps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Range<const N: usize> {
    pub(crate) low: [f64; N],
    /// A step, on all axes.
    pub(crate) step: f64,
}

impl<const N: usize> Range<N> {
    pub(crate) fn of(values: impl Iterator<Item = [f64; N]>) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; N], [f64::NEG_INFINITY; N]);
        for value in values {
            low = std::array::from_fn(|i| low[i].min(value[i]));
            high = std::array::from_fn(|i| high[i].max(value[i]));
        }
        let extent = (0..N).map(|i| high[i] - low[i]).fold(0.0, f64::max);
        let is_range = extent.is_finite() && extent > 0.0;
        Self {
            low: low.map(|x| if x.is_finite() { x } else { 0.0 }),
            step: if is_range { extent / STEPS } else { 1.0 },
        }
    }

    fn steps(&self, value: [f64; N]) -> [u16; N] {
        std::array::from_fn(|i| ((value[i] - self.low[i]) / self.step).round() as u16)
    }
}

/// Texture coordinates: those of each vertex's first corner, and of the corners that differ from it, which are along seams.
pub(crate) fn coordinates(
    numbering: &Numbering,
    triangles: &[[u32; 3]],
    uv: &[[[f32; 2]; 3]],
) -> (Range<2>, Vec<u8>, Vec<u8>) {
    let wide = |p: [f32; 2]| p.map(f64::from);
    let range = Range::of(uv.as_flattened().iter().map(|&p| wide(p)));
    let mut first: Vec<Option<[f32; 2]>> = vec![None; numbering.number.len()];
    let mut others = Vec::new();
    let mut last = 0;
    for (corner, (&v, &p)) in triangles.as_flattened().iter().zip(uv.as_flattened()).enumerate() {
        if *first[v as usize].get_or_insert(p) != p {
            push(&mut others, (corner - last) as u64);
            range.steps(wide(p)).iter().for_each(|step| others.extend(step.to_le_bytes()));
            last = corner;
        }
    }
    let firsts = numbering.values(range, |v| first[v as usize].map_or(range.low, wide));
    (range, firsts, others)
}

/// Chains of the model's vertices: the length of each, then its vertices as differences.
pub(crate) fn chains(numbering: &Numbering, chains: &[Vec<u32>]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for chain in chains {
        push(&mut bytes, chain.len() as u64);
        differences(&mut bytes, chain.iter().map(|&v| numbering.number[v as usize]));
    }
    bytes
}

/// Numbers as differences from the one before.
pub(crate) fn sequence(numbers: impl Iterator<Item = u32>) -> Vec<u8> {
    let mut bytes = Vec::new();
    differences(&mut bytes, numbers);
    bytes
}

/// Logarithms from `-most` to `most` in a byte each, as differences from the one before.
pub(crate) fn logarithms(values: impl Iterator<Item = f64>, most: f64) -> Vec<u8> {
    let mut last = 0_u8;
    let mut byte = |value: f64| {
        let now = (127.5 + 127.5 * (value / most).clamp(-1.0, 1.0)).round() as u8;
        now.wrapping_sub(std::mem::replace(&mut last, now))
    };
    values.map(|value| byte(if value.is_nan() { 0.0 } else { value })).collect()
}

fn differences(bytes: &mut Vec<u8>, numbers: impl Iterator<Item = u32>) {
    let mut last = 0;
    for number in numbers {
        let difference = i64::from(number) - last;
        last = i64::from(number);
        push(bytes, (difference << 1 ^ difference >> 63) as u64);
    }
}

/// Seven bits a byte, the lowest first, the eighth where there are more.
fn push(bytes: &mut Vec<u8>, mut number: u64) {
    while number >= 0x80 {
        bytes.push(number as u8 | 0x80);
        number >>= 7;
    }
    bytes.push(number as u8);
}

/// A small difference to either side as a small number.
fn folded(difference: u16) -> u16 {
    let signed = difference as i16;
    (signed << 1 ^ signed >> 15) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_are_numbered_as_triangles_name_them() {
        let triangles = [[7, 2, 5], [5, 2, 0]];
        let numbering = Numbering::new(9, &triangles);
        assert_eq!(numbering.vertex, [7, 2, 5, 0]);
        assert_eq!(numbering.from, [0, 0, 0, 2]);
        assert_eq!(numbering.triangles(&triangles), [0, 0, 0, 1, 2, 0]);
    }

    #[test]
    fn steps_are_told_as_differences_low_bytes_first() {
        let numbering = Numbering::new(3, &[[0, 1, 2]]);
        let values = [[0.0], [1.0], [257.0]];
        let range = Range { low: [0.0], step: 1.0 };
        assert_eq!(numbering.values(range, |v| values[v as usize]), [0, 2, 2, 0, 0, 2]);
        let back = [0, 1, 2].map(|k| folded([0_u16, 65_535, 1][k]));
        assert_eq!(back, [0, 1, 2]);
    }

    #[test]
    fn nothing_at_all_has_a_range() {
        let range = Range::<2>::of(std::iter::empty());
        assert!(range.step > 0.0 && range.low == [0.0; 2]);
        assert_eq!(range.steps([f64::NAN; 2]), [0; 2]);
    }
}

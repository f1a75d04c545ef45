//! The Sobol sequence.

use super::directions::DIRECTIONS;

/// The number of dimensions: the first one has no entry in the table.
pub(crate) const DIMENSIONS: usize = DIRECTIONS.len() + 1;

const BITS: usize = 32;

/// One dimension of the sequence.
///
/// Source: S. Joe, F. Y. Kuo, "Constructing Sobol sequences with better two-dimensional
/// projections", SIAM Journal on Scientific Computing 30 (2008), 2635–2654; points in the order of
/// the Gray code (I. A. Antonov, V. M. Saleev, 1979).
#[derive(Clone, Debug)]
pub(crate) struct Sobol {
    /// The direction numbers, scaled to 32 bits.
    directions: [u32; BITS],
}

impl Sobol {
    /// The dimension with this index, which is less than [`DIMENSIONS`].
    pub fn new(dimension: usize) -> Option<Self> {
        let mut directions = [0; BITS];
        let entry = match dimension.checked_sub(1) {
            None => None,
            Some(index) => Some(DIRECTIONS.get(index)?),
        };
        for index in 0..BITS {
            directions[index] = match entry {
                None => 1 << (BITS - 1 - index),
                Some((_, first)) if index < first.len() => first[index] << (BITS - 1 - index),
                Some((polynomial, first)) => next(&directions[..index], *polynomial, first.len()),
            };
        }
        Some(Self { directions })
    }

    /// The point with this index, times 2³². Indexes from 2³² on repeat.
    pub fn point(&self, index: u64) -> u32 {
        let gray = index ^ (index >> 1);
        let used = self.directions.iter().enumerate().filter(|(bit, _)| gray >> bit & 1 == 1);
        used.fold(0, |point, (_, direction)| point ^ direction)
    }
}

/// The recurrence of a primitive polynomial of this degree.
fn next(known: &[u32], polynomial: u32, degree: usize) -> u32 {
    let before = |distance: usize| known[known.len() - distance];
    let start = before(degree) ^ (before(degree) >> degree);
    (1..degree)
        .filter(|distance| polynomial >> (degree - 1 - distance) & 1 == 1)
        .fold(start, |sum, distance| sum ^ before(distance))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_those_of_scipy() {
        // The index of a point, and its coordinates with 30 bits.
        let file = include_str!("../../../../tests/campaign/scipy.json");
        let results: serde_json::Value = serde_json::from_str(file).expect("JSON");
        let rows: Vec<Vec<u32>> = serde_json::from_value(results["sobol"].clone()).expect("rows");
        assert!(rows.len() > 10);
        for row in rows {
            assert_eq!(row.len(), DIMENSIONS + 1);
            for (dimension, expected) in row[1..].iter().enumerate() {
                let point = Sobol::new(dimension).expect("a dimension").point(row[0].into());
                assert_eq!(point, expected << 2, "point {} of dimension {dimension}", row[0]);
            }
        }
    }

    #[test]
    fn each_dimension_has_one_point_in_each_interval() {
        for dimension in 0..DIMENSIONS {
            let sobol = Sobol::new(dimension).expect("a dimension");
            let mut upper: Vec<u32> = (0..1024).map(|index| sobol.point(index) >> 22).collect();
            upper.sort_unstable();
            assert!(upper.iter().copied().eq(0..1024), "{dimension}");
        }
        assert!(Sobol::new(DIMENSIONS).is_none());
    }
}

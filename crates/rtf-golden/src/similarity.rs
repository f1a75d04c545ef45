//! Structural similarity of two pictures: Wang, Bovik, Sheikh, Simoncelli, *Image quality assessment:
//! from error visibility to structural similarity*, IEEE Transactions on Image Processing 13, 2004.

use std::collections::VecDeque;

use crate::picture::Picture;
use crate::picture_error::PictureError;
use crate::pixels::Pixels;

/// Pixels between the middle and the border of a window.
const RADIUS: usize = 5;
/// The width and the height of a window, in pixels.
const SIDE: usize = 2 * RADIUS + 1;
/// The standard deviation of the window's weights, in pixels.
const SIGMA: f64 = 1.5;
/// `(K1 L)²` and `(K2 L)²`, which bound the quotients of dark and of even parts.
const STABILISERS: (f64, f64) = (2.55 * 2.55, 7.65 * 7.65);

/// Sums of a row: both means, both squares, the product.
type Moments = [Vec<f64>; 5];

#[derive(Clone, Debug)]
pub struct PictureDifference {
    /// 1 minus the mean similarity of all windows and colours: from 0 (equal) to 2.
    pub size: f64,
    /// The middle of the window with the largest difference: column and row, from 0.
    pub worst: (u32, u32),
    /// The difference of each window, by rows.
    local: Vec<f32>,
}

impl PictureDifference {
    /// Compares two pictures of the same size.
    ///
    /// # Errors
    /// Their sizes differ.
    pub fn of(got: &Picture, expected: &Picture) -> Result<Self, PictureError> {
        let (got, expected) = (&got.pixels, &expected.pixels);
        if got.size != expected.size {
            return Err(PictureError::Sizes { got: got.size, expected: expected.size });
        }
        let columns = got.size.0 as usize - 2 * RADIUS;
        let rows = got.size.1 as usize - 2 * RADIUS;
        let mut local = vec![0.0f32; columns * rows];
        let mut sum = 0.0;
        for colour in 0..3 {
            let differences = Windows { got, expected, colour }.differences();
            for (total, difference) in local.iter_mut().zip(differences.flatten()) {
                sum += difference;
                *total += (difference / 3.0) as f32;
            }
        }
        let largest = (0..local.len()).max_by(|a, b| local[*a].total_cmp(&local[*b])).unwrap_or(0);
        let worst = (largest % columns + RADIUS, largest / columns + RADIUS);
        // Rounding must not make equal pictures different.
        let size = if got == expected { 0.0 } else { sum / (3 * local.len()) as f64 };
        Ok(Self { size, worst: (worst.0 as u32, worst.1 as u32), local })
    }

    /// The reference in light grey, with differences in red, as a PNG file.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn picture(&self, expected: &Picture) -> Result<Vec<u8>, PictureError> {
        let (width, height) = expected.pixels.size;
        let columns = width as usize - 2 * RADIUS;
        let rows = height as usize - 2 * RADIUS;
        let drawn = Pixels::draw((width, height), |x, y| {
            // A pixel at the border has the difference of the nearest window.
            let column = (x as usize).saturating_sub(RADIUS).min(columns - 1);
            let row = (y as usize).saturating_sub(RADIUS).min(rows - 1);
            let difference = f64::from(self.local[row * columns + column]).clamp(0.0, 1.0);
            let [red, green, blue] = expected.pixels.at(x, y).map(f64::from);
            let grey = 128.0 + 0.5 * (0.299 * red + 0.587 * green + 0.114 * blue);
            let other = (grey * (1.0 - difference)) as u8;
            [(grey + (255.0 - grey) * difference) as u8, other, other]
        });
        drawn.to_png()
    }
}

/// The windows of one colour.
struct Windows<'a> {
    got: &'a Pixels,
    expected: &'a Pixels,
    colour: usize,
}

impl Windows<'_> {
    /// The differences of all windows, by rows. The weights are a product, so rows are summed
    /// first; only as many as a window has are kept.
    fn differences(self) -> impl Iterator<Item = Vec<f64>> {
        let weights = weights();
        let mut kept: VecDeque<Moments> = VecDeque::with_capacity(SIDE);
        (0..self.got.size.1).filter_map(move |row| {
            if kept.len() == SIDE {
                kept.pop_front();
            }
            kept.push_back(self.moments(row, &weights));
            (kept.len() == SIDE).then(|| row_differences(&kept, &weights))
        })
    }

    fn moments(&self, row: u32, weights: &[f64; SIDE]) -> Moments {
        let values = |picture: &Pixels| -> Vec<f64> {
            picture.row(row).iter().map(|pixel| f64::from(pixel[self.colour])).collect()
        };
        let (got, expected) = (values(self.got), values(self.expected));
        let product =
            |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a * b).collect() };
        let squares = [product(&got, &got), product(&expected, &expected)];
        let both = product(&got, &expected);
        let [got_square, expected_square] = squares;
        [got, expected, got_square, expected_square, both].map(|values| {
            let windows = values.windows(SIDE);
            windows.map(|window| window.iter().zip(weights).map(|(v, w)| v * w).sum()).collect()
        })
    }
}

fn row_differences(rows: &VecDeque<Moments>, weights: &[f64; SIDE]) -> Vec<f64> {
    let columns = rows[0][0].len();
    let sum = |moment: usize, column: usize| -> f64 {
        rows.iter().zip(weights).map(|(row, weight)| row[moment][column] * weight).sum()
    };
    let difference = |column| {
        let [got, expected, got_square, expected_square, both] =
            [0, 1, 2, 3, 4].map(|moment| sum(moment, column));
        let (c1, c2) = STABILISERS;
        let variances = got_square - got * got + expected_square - expected * expected;
        let covariance = both - got * expected;
        let means = got * got + expected * expected;
        1.0 - (2.0 * got * expected + c1) * (2.0 * covariance + c2)
            / ((means + c1) * (variances + c2))
    };
    (0..columns).map(difference).collect()
}

/// The weights of a row of a window.
fn weights() -> [f64; SIDE] {
    let weight = |index: usize| (-0.5 * ((index as f64 - RADIUS as f64) / SIGMA).powi(2)).exp();
    let weights: [f64; SIDE] = std::array::from_fn(weight);
    let sum: f64 = weights.iter().sum();
    weights.map(|weight| weight / sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(draw: impl Fn(u32, u32) -> [u8; 3]) -> Picture {
        Picture::decode(&Pixels::draw((60, 40), draw).to_png().unwrap()).unwrap()
    }

    fn scene(x: u32, y: u32) -> [u8; 3] {
        [(4 * x) as u8, (6 * y) as u8, ((x + y) % 16 * 15) as u8]
    }

    #[test]
    fn equal_pictures_have_no_difference() {
        let scene = picture(scene);
        assert_eq!(PictureDifference::of(&scene, &scene).unwrap().size, 0.0);
    }

    #[test]
    fn black_and_white_have_the_difference_of_the_definition() {
        let difference =
            PictureDifference::of(&picture(|_, _| [0; 3]), &picture(|_, _| [255; 3])).unwrap();
        let (c1, _) = STABILISERS;
        assert!((difference.size - (1.0 - c1 / (255.0 * 255.0 + c1))).abs() < 1e-12);
    }

    #[test]
    fn the_worst_place_is_where_the_pictures_differ_and_it_is_red() {
        let expected = picture(scene);
        let got = picture(|x, y| match (x, y) {
            (38..=42, 18..=22) => [0; 3],
            _ => scene(x, y),
        });
        let difference = PictureDifference::of(&got, &expected).unwrap();
        let (x, y) = difference.worst;
        assert!(x.abs_diff(40) <= 5 && y.abs_diff(20) <= 5, "{x}, {y}");
        assert!(difference.size > 0.01 && difference.size < 0.2, "{}", difference.size);
        let drawn = Picture::decode(&difference.picture(&expected).unwrap()).unwrap();
        let [red, green, _] = drawn.pixels.at(x, y);
        assert!(red > green + 50, "{red} {green}");
        let [red, green, blue] = drawn.pixels.at(5, 5);
        assert!(red.abs_diff(green) <= 1 && green == blue);
    }

    #[test]
    fn colours_of_the_same_brightness_differ() {
        let got = picture(|_, _| [200, 0, 0]);
        let expected = picture(|_, _| [0, 102, 0]);
        assert!(PictureDifference::of(&got, &expected).unwrap().size > 0.3);
    }
}

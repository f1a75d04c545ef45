//! Random numbers that are the same on every machine and in every version, as specified in
//! `spec/campaign.md`.

use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng as _, SeedableRng as _};
use sha2::{Digest as _, Sha256};

/// 2⁻⁵³: half the distance of two random numbers.
const HALF_STEP: f64 = f64::EPSILON / 2.0;

/// A sequence of random numbers with access by index.
///
/// Source: D. J. Bernstein, "ChaCha, a variant of Salsa20" (2008), with 8 rounds and the original
/// 64-bit counter and 64-bit nonce. The seed is in the key; the stream is the nonce.
#[derive(Debug)]
pub struct RandomStream {
    generator: ChaCha8Rng,
}

impl RandomStream {
    /// The stream for `purpose` and `name` of a seed. Different names have unrelated streams.
    #[must_use]
    pub fn new(seed: u64, purpose: &str, name: &str) -> Self {
        let mut key = [0; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        let mut generator = ChaCha8Rng::from_seed(key);
        let digest = Sha256::digest(format!("{purpose}/{name}"));
        let mut nonce = [0; 8];
        nonce.copy_from_slice(&digest[..8]);
        generator.set_stream(u64::from_le_bytes(nonce));
        Self { generator }
    }

    /// The number with this index: 64 random bits.
    pub fn bits(&mut self, index: u64) -> u64 {
        self.generator.set_block_pos(index);
        self.generator.next_u64()
    }

    /// The number with this index as a real between 0 and 1, both excluded.
    pub fn unit(&mut self, index: u64) -> f64 {
        unit(self.bits(index))
    }

    /// The numbers from the start of the stream, eight for each index of [`RandomStream::bits`].
    pub fn sequence(mut self) -> impl Iterator<Item = u64> {
        self.generator.set_block_pos(0);
        std::iter::repeat_with(move || self.generator.next_u64())
    }
}

/// The real number between 0 and 1, both excluded, with the upper 52 bits: (2·⌊x/2¹²⌋ + 1)/2⁵³.
#[must_use]
#[expect(clippy::cast_precision_loss, reason = "a number below 2^53")]
pub fn unit(bits: u64) -> f64 {
    (((bits >> 12) << 1) | 1) as f64 * HALF_STEP
}

/// An index below `count` from random bits: the bias is below `count`/2⁶⁴.
#[must_use]
pub fn index_below(bits: u64, count: usize) -> usize {
    let index = (u128::from(bits) * count as u128) >> 64;
    usize::try_from(index).unwrap_or_default()
}

/// The quantile of the standard normal distribution for a probability between 0 and 1.
///
/// Source: M. J. Wichura, "Algorithm AS 241: The percentage points of the normal distribution",
/// Applied Statistics 37 (1988), 477–484, procedure PPND16, with a relative error of about 1e-16.
/// NaN for other probabilities.
#[must_use]
pub fn normal_quantile(probability: f64) -> f64 {
    if !crate::is_probability(probability) {
        return f64::NAN;
    }
    let q = probability - 0.5;
    if q.abs() <= 0.425 {
        let r = 0.180_625 - q * q;
        let [numerator, denominator] = polynomials(&CENTRE, r);
        // In this order, as published: the last bit depends on it.
        return q * numerator / denominator;
    }
    let tail = if q < 0.0 { probability } else { 1.0 - probability };
    let r = (-libm::log(tail)).sqrt();
    let [numerator, denominator] =
        if r <= 5.0 { polynomials(&MIDDLE, r - 1.6) } else { polynomials(&FAR, r - 5.0) };
    let quantile = numerator / denominator;
    if q < 0.0 { -quantile } else { quantile }
}

/// The coefficients of a numerator and a denominator, from the highest power to the constant.
type Ratio = [[f64; 8]; 2];

fn polynomials(coefficients: &Ratio, x: f64) -> [f64; 2] {
    coefficients.map(|polynomial| polynomial.iter().fold(0.0, |sum, c| sum * x + c))
}

/// For probabilities within 0.425 of 0.5.
const CENTRE: Ratio = [
    [
        2_509.080_928_730_122_7,
        33_430.575_583_588_13,
        67_265.770_927_008_7,
        45_921.953_931_549_87,
        13_731.693_765_509_46,
        1_971.590_950_306_551_3,
        133.141_667_891_784_38,
        3.387_132_872_796_366_5,
    ],
    [
        5_226.495_278_852_545,
        28_729.085_735_721_943,
        39_307.895_800_092_71,
        21_213.794_301_586_597,
        5_394.196_021_424_751,
        687.187_007_492_057_9,
        42.313_330_701_600_91,
        1.0,
    ],
];

/// For tails down to about 1.4e-11.
const MIDDLE: Ratio = [
    [
        7.745_450_142_783_414e-4,
        0.022_723_844_989_269_184,
        0.241_780_725_177_450_6,
        1.270_458_252_452_368_4,
        3.647_848_324_763_204_5,
        5.769_497_221_460_691,
        4.630_337_846_156_546,
        1.423_437_110_749_683_5,
    ],
    [
        1.050_750_071_644_416_9e-9,
        5.475_938_084_995_345e-4,
        0.015_198_666_563_616_457,
        0.148_103_976_427_480_08,
        0.689_767_334_985_1,
        1.676_384_830_183_803_8,
        2.053_191_626_637_759,
        1.0,
    ],
];

/// For smaller tails.
const FAR: Ratio = [
    [
        2.010_334_399_292_288_1e-7,
        2.711_555_568_743_487_6e-5,
        0.001_242_660_947_388_078_4,
        0.026_532_189_526_576_124,
        0.296_560_571_828_504_87,
        1.784_826_539_917_291_3,
        5.463_784_911_164_114,
        6.657_904_643_501_103,
    ],
    [
        2.044_263_103_389_939_8e-15,
        1.421_511_758_316_446e-7,
        1.846_318_317_510_054_8e-5,
        7.868_691_311_456_133e-4,
        0.014_875_361_290_850_615,
        0.136_929_880_922_735_8,
        0.599_832_206_555_888,
        1.0,
    ],
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_generator_is_chacha_with_eight_rounds() {
        // The key stream of ChaCha8 for a key and a nonce of zeros:
        // draft-strombergson-chacha-test-vectors, TC1, 256-bit key.
        let mut zero = RandomStream { generator: ChaCha8Rng::from_seed([0; 32]) };
        assert_eq!(zero.bits(0).to_le_bytes(), [0x3e, 0x00, 0xef, 0x2f, 0x89, 0x5f, 0x40, 0xd6]);
        assert_eq!(zero.bits(1).to_le_bytes(), [0xd2, 0xae, 0xfa, 0x0d, 0xea, 0xa5, 0xc1, 0x51]);
    }

    #[test]
    fn numbers_depend_on_seed_purpose_name_and_index_only() {
        let mut stream = RandomStream::new(7, "value", "payload");
        let third = stream.bits(3);
        assert_ne!(stream.bits(2), third);
        assert_eq!(stream.bits(3), third);
        for (seed, purpose, name) in
            [(8, "value", "payload"), (7, "shift", "payload"), (7, "value", "friction")]
        {
            assert_ne!(RandomStream::new(seed, purpose, name).bits(3), third);
        }
        let first = [stream.bits(0), stream.bits(1)];
        let sequence: Vec<u64> = stream.sequence().take(9).collect();
        assert_eq!([sequence[0], sequence[8]], first);
    }

    #[test]
    fn a_real_is_made_of_the_bits_with_the_same_index() {
        let mut stream = RandomStream::new(7, "value", "payload");
        let reals = [0, 1, 5].map(|index| stream.unit(index));
        assert_eq!(reals, [0, 1, 5].map(|index| unit(stream.bits(index))));
        assert!(reals.iter().all(|real| 0.0 < *real && *real < 1.0), "{reals:?}");
        assert_ne!(reals[0], reals[1]);
    }

    #[test]
    fn reals_exclude_both_ends() {
        assert_eq!(unit(0), 2.0_f64.powi(-53));
        assert_eq!(unit(u64::MAX), 1.0 - 2.0_f64.powi(-53));
        assert_eq!(unit(1 << 63), 0.5 + 2.0_f64.powi(-53));
    }

    #[test]
    fn quantiles_have_no_value_outside_of_probabilities() {
        for probability in [0.0, 1.0, -1.0, 2.0, f64::NAN] {
            assert!(normal_quantile(probability).is_nan());
        }
        assert_eq!(normal_quantile(0.5), 0.0);
    }
}

//! One kernel in plain Rust, compiled once for each instruction set, and the choice between them at run time.
//!
//! A kernel is written once, as loops over plain `f64` slices; the compiler vectorizes it for each set. It
//! uses only additions, subtractions, multiplications, divisions, square roots and comparisons, in the
//! written order, and never a fused multiply-add: Rust contracts no operations by itself. So the results are
//! bit-identical on every set, and [`Isa::Plain`] is the reference for the others.
//!
//! The environment variable `CHORDAL_ISA` = `plain`, `avx2` or `avx512` selects a set, for tests and
//! comparisons. If a value is unknown, or this processor lacks the set, `plain` is used, which is always
//! available and gives the same results. (A caller that wants to report this parses the value as [`Isa`] and
//! checks [`Isa::is_available`].)
use std::fmt;
use std::str::FromStr;
use std::sync::OnceLock;

/// A set of instructions that kernels are compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Isa {
    /// The instruction set that the program was compiled for. This includes SSE2 on x86-64, NEON on 64-bit
    /// ARM and, if enabled at compile time, simd128 on WebAssembly, which has no choice at run time.
    Plain,
    /// AVX2: four f64 at once.
    Avx2,
    /// AVX-512 (F, VL, DQ): eight f64 at once.
    Avx512,
}

impl Isa {
    /// All sets, the widest last.
    pub const ALL: [Self; 3] = [Self::Plain, Self::Avx2, Self::Avx512];

    /// Whether this processor supports it.
    #[must_use]
    pub fn is_available(self) -> bool {
        match self {
            Self::Plain => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => is_x86_feature_detected!("avx2"),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => {
                // All three sets that the copy of the kernel for AVX-512 is compiled for.
                is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512vl")
                    && is_x86_feature_detected!("avx512dq")
            }
            #[cfg(not(target_arch = "x86_64"))]
            _ => false,
        }
    }

    /// The set that is used when `CHORDAL_ISA` has the value `request`.
    fn choose(request: Option<&str>) -> Self {
        let available = |isa: &Self| isa.is_available();
        match request {
            None | Some("") => Self::ALL.into_iter().rfind(available).unwrap_or(Self::Plain),
            Some(name) => name.parse().ok().filter(available).unwrap_or(Self::Plain),
        }
    }

    /// The name, as in `CHORDAL_ISA`.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Plain => "plain",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }
}

/// The set that kernels run on by default: chosen at the first call and constant afterwards.
#[must_use]
pub fn isa() -> Isa {
    static CHOSEN: OnceLock<Isa> = OnceLock::new();
    // WASM has one set, and modules read no environment variables of their hosts.
    let request = || if cfg!(target_family = "wasm") { None } else { std::env::var("CHORDAL_ISA").ok() };
    *CHOSEN.get_or_init(|| Isa::choose(request().as_deref()))
}

/// Work that is compiled for every instruction set.
///
/// `run` and all functions that it calls in its inner loops must be `#[inline(always)]`: only inlined code is
/// compiled for the set.
///
/// ```
/// use chordal::math::simd::{self, Isa, Kernel};
/// struct Halve<'a>(&'a mut [f64]);
/// impl Kernel for Halve<'_> {
///     type Output = ();
///     #[inline(always)]
///     fn run(self) {
///         self.0.iter_mut().for_each(|x| *x *= 0.5);
///     }
/// }
/// let mut numbers = [1.0, 2.0, 3.0];
/// simd::dispatch(simd::isa(), Halve(&mut numbers));
/// simd::dispatch(Isa::Plain, Halve(&mut numbers));
/// assert_eq!(numbers, [0.25, 0.5, 0.75]);
/// ```
pub trait Kernel {
    /// The result of the work.
    type Output;

    /// Does the work.
    fn run(self) -> Self::Output;
}

/// Runs `kernel` as compiled for `isa`, or for [`Isa::Plain`] when this processor does not have that set.
#[inline]
pub fn dispatch<K: Kernel>(isa: Isa, kernel: K) -> K::Output {
    match isa {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the features that `on_avx2` is compiled for were found in this processor.
        Isa::Avx2 if isa.is_available() => unsafe { on_avx2(kernel) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the features that `on_avx512` is compiled for were found in this processor.
        Isa::Avx512 if isa.is_available() => unsafe { on_avx512(kernel) },
        _ => on_plain(kernel),
    }
}

/// A call as for the other sets: inlined, a kernel would be copied to each of its callers, which made a module for browsers
/// that asks fields a fifth larger.
#[inline(never)]
fn on_plain<K: Kernel>(kernel: K) -> K::Output {
    kernel.run()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn on_avx2<K: Kernel>(kernel: K) -> K::Output {
    kernel.run()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq")]
fn on_avx512<K: Kernel>(kernel: K) -> K::Output {
    kernel.run()
}

impl fmt::Display for Isa {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

impl FromStr for Isa {
    type Err = UnknownIsa;

    fn from_str(text: &str) -> Result<Self, UnknownIsa> {
        Self::ALL.into_iter().find(|isa| isa.as_str() == text).ok_or_else(|| UnknownIsa(text.to_owned()))
    }
}

/// The error for a text that names no instruction set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownIsa(String);

impl fmt::Display for UnknownIsa {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "an instruction set is plain, avx2 or avx512, not '{}'", self.0)
    }
}

impl std::error::Error for UnknownIsa {}

/// Prefetches the memory of an element that is read soon. It changes no result, and does nothing beyond the
/// end or on processors without such an instruction.
#[inline]
pub(crate) fn prefetch<T>(slice: &[T], index: usize) {
    #[cfg(target_arch = "x86_64")]
    if let Some(element) = slice.get(index) {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: SSE, which every x86-64 has; the address is that of an element, and nothing is read or
        // written.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(element).cast()) }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (slice, index);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn takes_the_widest_set_by_default() {
        let widest = Isa::choose(None);
        assert!(widest.is_available());
        assert!(Isa::ALL.into_iter().skip_while(|isa| *isa != widest).skip(1).all(|isa| !isa.is_available()));
        assert_eq!(Isa::choose(Some("")), widest);
    }

    #[test]
    fn takes_the_requested_set_if_available_and_otherwise_plain() {
        for isa in Isa::ALL {
            let expected = if isa.is_available() { isa } else { Isa::Plain };
            assert_eq!(Isa::choose(Some(isa.as_str())), expected);
        }
        assert_eq!(Isa::choose(Some("mmx")), Isa::Plain);
        assert_eq!(Isa::choose(Some("AVX2")), Isa::Plain);
    }
}

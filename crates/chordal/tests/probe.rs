//! The probe for flushed subnormals, against a processor that really flushes them.
use chordal::math::flushes_subnormals;

#[test]
fn a_normal_environment_is_not_accused() {
    assert!(!flushes_subnormals());
}

#[cfg(target_arch = "x86_64")]
mod switched_on {
    use super::flushes_subnormals;
    use std::arch::asm;

    /// Results that would be subnormal become 0.
    const FTZ: u32 = 1 << 15;
    /// Subnormal operands count as 0.
    const DAZ: u32 = 1 << 6;

    extern "C" fn probe() -> u32 {
        u32::from(flushes_subnormals())
    }

    /// Runs the probe with `bits` set in the control register of this thread.
    fn probe_with(bits: u32) -> bool {
        let mut saved = 0_u32;
        // SAFETY: stores the control register to a live u32.
        unsafe { asm!("stmxcsr [{}]", in(reg) &mut saved) };
        let changed = saved | bits;
        let found: u32;
        // SAFETY: only the two flush bits differ while the probe runs, it calls nothing else, and the
        // register is restored before the block ends; all registers that the call may change are declared.
        unsafe {
            asm!(
                "ldmxcsr [r12]",
                "call {probe}",
                "ldmxcsr [r13]",
                probe = sym probe,
                in("r12") &changed,
                in("r13") &saved,
                out("eax") found,
                clobber_abi("C"),
            );
        }
        found != 0
    }

    #[test]
    fn each_way_of_flushing_is_found() {
        assert!(probe_with(FTZ), "flushed results");
        assert!(probe_with(DAZ), "flushed operands");
        assert!(probe_with(FTZ | DAZ), "both");
    }

    #[test]
    fn the_environment_is_as_before() {
        assert!(!probe_with(0));
        probe_with(FTZ | DAZ);
        assert!(!flushes_subnormals());
    }
}

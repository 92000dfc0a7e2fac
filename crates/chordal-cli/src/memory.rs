//! How much memory a job may take where nobody says it: a share of what the machine, or the group of
//! processes, has. And how much triangles take at least.
use chordal_io::Scene;

/// The share of the memory: half, chosen so that a job and what reads its result fit side by side.
const SHARE: u64 = 2;

/// Half of the memory that this process can have: of the machine's, or of the limit of its control group
/// where that is less. None where the system does not say.
#[cfg(not(target_family = "wasm"))]
#[must_use]
pub fn default_limit() -> Option<u64> {
    default_limit_from(&|path| std::fs::read_to_string(path).ok())
}

/// Half of what a module can address, 4 GiB: what is beyond ends in a sentence, and not in a trap.
#[cfg(target_family = "wasm")]
#[must_use]
pub fn default_limit() -> Option<u64> {
    Some((1_u64 << u32::BITS) / SHARE)
}

/// The least memory, in bytes, for reading the triangles of a file of so many bytes and for any work on them: its bytes
/// and the triangles, then these and the neighbours of each triangle, which every verb looks up. Measured on a million
/// triangles in nine formats: `inspect` and `convert` hold 1.2 to 1.7 times this at most, of a 3MF 4 times, whose text is
/// packed.
#[must_use]
pub fn least_for(scene: &Scene, n_file_bytes: u64) -> u64 {
    let (mut held, mut neighbours) = (0, 0);
    for mesh in scene.parts.iter().map(|part| &part.mesh) {
        let values: usize = mesh.attributes().iter().map(|attribute| attribute.values.len()).sum();
        let ids = mesh.position_id().map_or(0, size_of_val);
        held += size_of_val(mesh.positions()) + size_of_val(mesh.faces()) + size_of::<f64>() * values + ids;
        // Of the largest part: one after the other is looked at. 12 bytes a triangle and 4 a row, as
        // `MeshConnectivity` says.
        neighbours = neighbours.max(12 * mesh.faces().len() + 4 * mesh.positions().len());
    }
    held as u64 + n_file_bytes.max(neighbours as u64)
}

/// The same, where `read` knows the system's files.
#[cfg_attr(target_family = "wasm", expect(dead_code, reason = "there are no such files"))]
fn default_limit_from(read: &dyn Fn(&str) -> Option<String>) -> Option<u64> {
    let machine = read("/proc/meminfo").and_then(|text| total(&text));
    let most = groups(read).into_iter().chain(machine).min()?;
    Some(most / SHARE)
}

/// `MemTotal:       24035120 kB`
fn total(text: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix("MemTotal:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kilobytes.checked_mul(1024)
}

/// The limits of the control groups that the process is in, and of those around them: Linux' versions 2 and
/// 1.
fn groups(read: &dyn Fn(&str) -> Option<String>) -> Vec<u64> {
    let text = read("/proc/self/cgroup").unwrap_or_default();
    let mut limits = Vec::new();
    for line in text.lines() {
        // hierarchy:controllers:path
        let mut parts = line.splitn(3, ':').skip(1);
        let (Some(controllers), Some(path)) = (parts.next(), parts.next()) else { continue };
        let (folder, name) = match controllers {
            "" => ("/sys/fs/cgroup", "memory.max"),
            _ if controllers.split(',').any(|one| one == "memory") => {
                ("/sys/fs/cgroup/memory", "memory.limit_in_bytes")
            }
            _ => continue,
        };
        let mut group = path.trim_end_matches('/');
        loop {
            // "max" is no limit, and is no number.
            let limit = read(&format!("{folder}{group}/{name}"));
            limits.extend(limit.and_then(|text| text.trim().parse::<u64>().ok()));
            let Some(around) = group.rfind('/') else { break };
            group = &group[..around];
        }
    }
    limits
}

#[cfg(test)]
mod tests {
    use super::*;

    fn share_of(files: &[(&str, &str)]) -> Option<u64> {
        let found =
            |path: &str| files.iter().find(|(name, _)| *name == path).map(|(_, text)| (*text).to_owned());
        default_limit_from(&found)
    }

    const MEMINFO: (&str, &str) = ("/proc/meminfo", "MemTotal:        8388608 kB\nMemFree:  1 kB\n");

    #[test]
    fn half_of_the_machine_without_a_group() {
        assert_eq!(share_of(&[MEMINFO]), Some(4 << 30));
        assert_eq!(share_of(&[("/proc/meminfo", "MemTotal: much\n")]), None);
        assert_eq!(share_of(&[]), None);
    }

    #[test]
    fn half_of_the_narrowest_group() {
        let inside = ("/proc/self/cgroup", "0::/user/job\n");
        let outer = ("/sys/fs/cgroup/user/memory.max", "1073741824\n");
        let own = |limit| ("/sys/fs/cgroup/user/job/memory.max", limit);
        assert_eq!(share_of(&[MEMINFO, inside, outer, own("max\n")]), Some(512 << 20));
        assert_eq!(share_of(&[MEMINFO, inside, outer, own("536870912\n")]), Some(256 << 20));
        assert_eq!(share_of(&[MEMINFO, inside, own("max\n")]), Some(4 << 30));
        // A container sees its own group as the top.
        let top = [MEMINFO, ("/proc/self/cgroup", "0::/\n"), ("/sys/fs/cgroup/memory.max", "1048576\n")];
        assert_eq!(share_of(&top), Some(512 << 10));
        let first = ("/proc/self/cgroup", "5:cpu:/x\n4:hugetlb,memory:/y\n");
        let limit = |bytes| ("/sys/fs/cgroup/memory/y/memory.limit_in_bytes", bytes);
        assert_eq!(share_of(&[MEMINFO, first, limit("268435456\n")]), Some(128 << 20));
        // What stands for no limit in version 1.
        assert_eq!(share_of(&[MEMINFO, first, limit("9223372036854771712\n")]), Some(4 << 30));
    }
}

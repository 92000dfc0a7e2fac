//! The default memory limit of a job: a share of the memory of the machine or of the control group. And the
//! least memory that triangles need.
use chordal_io::Scene;

/// The divisor of the memory. Chosen: with half of it, a job and the program that reads its result fit side
/// by side.
const SHARE: u64 = 2;

/// Half of the memory available to this process: of the machine's, or of the limit of its control group if
/// that is less. `None` if it is not known.
#[cfg(not(target_family = "wasm"))]
#[must_use]
pub fn default_limit() -> Option<u64> {
    default_limit_from(&|path| std::fs::read_to_string(path).ok())
}

/// Half of the 4 GiB that a module can address: a job beyond it ends with a message instead of a trap.
#[cfg(target_family = "wasm")]
#[must_use]
pub fn default_limit() -> Option<u64> {
    Some((1_u64 << u32::BITS) / SHARE)
}

/// The least memory, in bytes, for reading a file of triangles and working on them: first the file's bytes
/// and the triangles, then the triangles and their neighbours, which every verb needs. Measured on a million
/// triangles in nine formats: `inspect` and `convert` take at most 1.2 to 1.7 times this, for 3MF 4 times,
/// since its text is compressed.
#[must_use]
pub fn least_for(scene: &Scene, n_file_bytes: u64) -> u64 {
    let (mut mesh_bytes, mut neighbours) = (0, 0);
    for mesh in scene.parts.iter().map(|part| &part.mesh) {
        let values: usize = mesh.attributes().iter().map(|attribute| attribute.values.len()).sum();
        let ids = mesh.position_id().map_or(0, size_of_val);
        mesh_bytes +=
            size_of_val(mesh.positions()) + size_of_val(mesh.faces()) + size_of::<f64>() * values + ids;
        // The largest part counts, since parts are processed one by one. Derived from `MeshConnectivity`: 12
        // bytes a triangle and 4 a row.
        neighbours = neighbours.max(12 * mesh.faces().len() + 4 * mesh.positions().len());
    }
    mesh_bytes as u64 + n_file_bytes.max(neighbours as u64)
}

/// The same; `read` returns the content of a system file.
#[cfg_attr(target_family = "wasm", expect(dead_code, reason = "there are no such files"))]
fn default_limit_from(read: &dyn Fn(&str) -> Option<String>) -> Option<u64> {
    let machine = read("/proc/meminfo").and_then(|text| total(&text));
    // A group inside of others has the least of their limits, whichever of them states it.
    let limit = groups(read).into_iter().chain(machine).min()?;
    Some(limit / SHARE)
}

/// `MemTotal:       24035120 kB`
fn total(text: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix("MemTotal:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kilobytes.checked_mul(1024)
}

/// The limits of the process's control groups and of their ancestors, in versions 2 and 1 of Linux's cgroups.
fn groups(read: &dyn Fn(&str) -> Option<String>) -> Vec<u64> {
    let text = read("/proc/self/cgroup").unwrap_or_default();
    let mut limits = Vec::new();
    for line in text.lines() {
        // hierarchy:controllers:path
        let mut parts = line.splitn(3, ':').skip(1);
        let (Some(controllers), Some(path)) = (parts.next(), parts.next()) else { continue };
        let (folder, name) = match controllers {
            "" => ("/sys/fs/cgroup", "memory.max"),
            _ if controllers.split(',').any(|controller| controller == "memory") => {
                ("/sys/fs/cgroup/memory", "memory.limit_in_bytes")
            }
            _ => continue,
        };
        let mut group = path.trim_end_matches('/');
        loop {
            // "max" means no limit and does not parse.
            let limit = read(&format!("{folder}{group}/{name}"));
            limits.extend(limit.and_then(|text| text.trim().parse::<u64>().ok()));
            // A limit of an ancestor holds for this group, too. Within a container the path may name none
            // of the visible folders; then the root, which is the last, has the container's own limit.
            let Some(parent) = group.rfind('/') else { break };
            group = &group[..parent];
        }
    }
    limits
}

#[cfg(test)]
mod tests {
    use super::*;

    fn share_of(files: &[(&str, &str)]) -> Option<u64> {
        let read =
            |path: &str| files.iter().find(|(name, _)| *name == path).map(|(_, text)| (*text).to_owned());
        default_limit_from(&read)
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
        let job_limit = |limit| ("/sys/fs/cgroup/user/job/memory.max", limit);
        assert_eq!(share_of(&[MEMINFO, inside, outer, job_limit("max\n")]), Some(512 << 20));
        assert_eq!(share_of(&[MEMINFO, inside, outer, job_limit("536870912\n")]), Some(256 << 20));
        assert_eq!(share_of(&[MEMINFO, inside, job_limit("max\n")]), Some(4 << 30));
        // A container sees its own group as the top.
        let top = [MEMINFO, ("/proc/self/cgroup", "0::/\n"), ("/sys/fs/cgroup/memory.max", "1048576\n")];
        assert_eq!(share_of(&top), Some(512 << 10));
        let first = ("/proc/self/cgroup", "5:cpu:/x\n4:hugetlb,memory:/y\n");
        let limit = |bytes| ("/sys/fs/cgroup/memory/y/memory.limit_in_bytes", bytes);
        assert_eq!(share_of(&[MEMINFO, first, limit("268435456\n")]), Some(128 << 20));
        // The value that means no limit in version 1.
        assert_eq!(share_of(&[MEMINFO, first, limit("9223372036854771712\n")]), Some(4 << 30));
    }
}

//! Memory that a time loop touches.

use std::fs;

/// Forgets which pages of this process's memory have been touched (Linux, proc(5), `clear_refs`); whether that could be
/// done.
pub fn forget_touched() -> bool {
    fs::write("/proc/self/clear_refs", "1\n").is_ok()
}

/// Memory of this process in bytes that has been touched since [`forget_touched`], code and files left out; `None`
/// where the system does not say.
#[must_use]
pub fn touched() -> Option<u64> {
    touched_in(&fs::read_to_string("/proc/self/smaps").ok()?)
}

/// Touched bytes from the text of `smaps`: the referenced parts of the heap and of mappings without a file.
fn touched_in(smaps: &str) -> Option<u64> {
    let (mut sum, mut counts, mut found) = (0, false, false);
    for line in smaps.lines() {
        let mut words = line.split_whitespace();
        let first = words.next()?;
        if !first.ends_with(':') {
            // Range, rights, offset, device, inode, then the name if there is one.
            counts = matches!(words.nth(4), None | Some("[heap]"));
        } else if counts && first == "Referenced:" {
            sum += 1024 * words.next()?.parse::<u64>().ok()?;
            found = true;
        }
    }
    found.then_some(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_memory_without_a_file_counts() {
        let smaps = "5580-5590 r-xp 00000000 fe:00 247 /usr/bin/master\nRss: 8 kB\nReferenced: 8 kB\n\
                     5600-5700 rw-p 00000000 00:00 0 [heap]\nSize: 100 kB\nReferenced: 40 kB\nVmFlags: rd wr\n\
                     7f00-7f10 rw-p 00000000 00:00 0 \nReferenced: 2 kB\n7f20-7f30 rw-p 0 00:00 0 [stack]\nReferenced: \
                     16 kB\n";
        assert_eq!(touched_in(smaps), Some(42 * 1024));
        assert_eq!(touched_in(""), None);
    }
}

//! Cut of the unknowns into blocks of which only neighbours couple.

/// Largest block: beyond it sparse factors are smaller and faster.
pub(super) const LARGEST: usize = 48;

/// Cuts unknowns, taken in their order, into consecutive blocks such that every entry of the symmetric pattern
/// (compressed columns, row indices ascending) lies in a block or between two neighbouring ones. Returns the first
/// unknown of each block and the number of unknowns, with the amount of numbers that a solution reads; `None` if blocks
/// would be large.
///
/// The first block decides: each further block ends with the last unknown that the block before it couples with. Among
/// all first blocks the one with the least storage is taken, with rows filled up to a multiple of `lanes`.
pub(super) fn cut(column_starts: &[usize], row_indices: &[usize], lanes: usize) -> Option<(Vec<usize>, usize)> {
    let size = column_starts.len() - 1;
    let reach: Vec<usize> = (0..size)
        .map(|column| {
            row_indices[column_starts[column]..column_starts[column + 1]]
                .last()
                .map_or(column, |&row| row.max(column))
        })
        .collect();
    let first = *reach.first()?;
    let candidates = (1..=(first + 1).min(LARGEST)).filter_map(|end| {
        let bounds = greedy(&reach, end)?;
        let storage = storage(&bounds, lanes);
        Some((bounds, storage))
    });
    candidates.min_by_key(|&(_, storage)| storage)
}

fn greedy(reach: &[usize], first_end: usize) -> Option<Vec<usize>> {
    let size = reach.len();
    let mut bounds = vec![0, first_end.min(size)];
    let mut start = 0;
    while bounds[bounds.len() - 1] < size {
        let end = bounds[bounds.len() - 1];
        let furthest = reach[start..end].iter().max().map_or(end, |&row| row + 1);
        let next = furthest.max(end + 1);
        if next - end > LARGEST {
            return None;
        }
        bounds.push(next);
        start = end;
    }
    Some(bounds)
}

/// Numbers of unknowns of the blocks between `bounds`, and of their rows, filled up to a multiple of `lanes`.
pub(super) fn shapes(bounds: &[usize], lanes: usize) -> (Vec<usize>, Vec<usize>) {
    let sizes = bounds.windows(2).map(|pair| pair[1] - pair[0]);
    sizes.map(|size| (size, size.next_multiple_of(lanes))).unzip()
}

/// Amount of numbers that a solution reads.
fn storage(bounds: &[usize], lanes: usize) -> usize {
    let (sizes, heights) = shapes(bounds, lanes);
    let blocks: usize = sizes.iter().zip(&heights).map(|(size, height)| height * size).sum();
    let couplings = sizes.windows(2).zip(heights.windows(2));
    let couplings: usize = couplings
        .map(|(sizes, heights)| heights[0] * sizes[1] + heights[1] * sizes[0])
        .sum();
    blocks + couplings
}

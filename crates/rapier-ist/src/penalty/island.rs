//! Which bodies must be solved together.

/// Groups `pairs` of body indices into islands: pairs that share a movable body are in one island.
///
/// Islands come in the order of their first pair, pairs in their own order, so the result depends on the input only.
pub(crate) fn islands(pairs: &[[usize; 2]], movable: &[bool]) -> Vec<Vec<usize>> {
    let mut parent: Vec<usize> = (0..movable.len()).collect();
    for &[a, b] in pairs.iter().filter(|[a, b]| movable[*a] && movable[*b]) {
        let (a, b) = (root(&mut parent, a), root(&mut parent, b));
        parent[a.max(b)] = a.min(b);
    }
    let mut island_of = vec![usize::MAX; movable.len()];
    let mut islands: Vec<Vec<usize>> = Vec::new();
    for (index, &[a, b]) in pairs.iter().enumerate() {
        let body = root(&mut parent, if movable[a] { a } else { b });
        if island_of[body] == usize::MAX {
            island_of[body] = islands.len();
            islands.push(Vec::new());
        }
        islands[island_of[body]].push(index);
    }
    islands
}

/// Representative of `i`, with path halving.
fn root(parent: &mut [usize], mut i: usize) -> usize {
    while parent[i] != i {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    i
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fixed_bodies_do_not_join_islands() {
        let movable = [false, true, true, true, true];
        let pairs = [[0, 1], [0, 2], [2, 3], [0, 4], [1, 4]];
        assert_eq!(islands(&pairs, &movable), vec![vec![0, 3, 4], vec![1, 2]]);
    }
}

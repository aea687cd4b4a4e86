//! Which bodies must be solved together.

/// What is solved together: indices of pairs and of joints.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Members {
    pub(crate) pairs: Vec<usize>,
    pub(crate) joints: Vec<usize>,
}

/// Groups `pairs` of body indices, and the `joints` between bodies, into islands: what shares a movable body is in one island. What
/// hangs on no pair is in none.
///
/// Islands come in the order of their first pair, pairs and joints in their own order, so the result depends on the input only.
pub(crate) fn islands(pairs: &[[usize; 2]], joints: &[[usize; 2]], movable: &[bool]) -> Vec<Members> {
    let mut parent: Vec<usize> = (0..movable.len()).collect();
    for &[a, b] in pairs.iter().chain(joints).filter(|[a, b]| movable[*a] && movable[*b]) {
        let (a, b) = (root(&mut parent, a), root(&mut parent, b));
        parent[a.max(b)] = a.min(b);
    }
    let mut island_of = vec![usize::MAX; movable.len()];
    let mut islands: Vec<Members> = Vec::new();
    for (index, &[a, b]) in pairs.iter().enumerate() {
        let body = root(&mut parent, if movable[a] { a } else { b });
        if island_of[body] == usize::MAX {
            island_of[body] = islands.len();
            islands.push(Members::default());
        }
        islands[island_of[body]].pairs.push(index);
    }
    for (index, &[a, b]) in joints.iter().enumerate() {
        let body = root(&mut parent, if movable[a] { a } else { b });
        if let Some(island) = islands.get_mut(island_of[body]) {
            island.joints.push(index);
        }
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
        let of_pairs = |pairs: Vec<usize>| Members { pairs, joints: Vec::new() };
        assert_eq!(islands(&pairs, &[], &movable), vec![of_pairs(vec![0, 3, 4]), of_pairs(vec![1, 2])]);
    }

    #[test]
    fn joints_join_islands_and_make_none() {
        let movable = [false, true, true, true, true, true];
        let joints = [[0, 1], [1, 2], [0, 4], [4, 5]];
        let expected =
            [Members { pairs: vec![0, 1], joints: vec![0, 1] }, Members { pairs: vec![2], joints: vec![] }];
        assert_eq!(islands(&[[0, 1], [2, 0], [3, 0]], &joints, &movable), expected);
    }
}

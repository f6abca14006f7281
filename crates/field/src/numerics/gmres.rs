//! Linear systems by the generalised minimal residual method.
//!
//! Source: Saad and Schultz, SIAM J. Sci. Stat. Comput. 7, 856 (1986).

/// Solves A x = b for x, from zero, until |b − A x| ≤ `tolerance` |b| or after so many products with A.
/// Returns x.
pub(crate) fn solve(
    product: impl Fn(&[f64], &mut Vec<f64>),
    right: &[f64],
    tolerance: f64,
    most: usize,
) -> Vec<f64> {
    let size = norm(right);
    if size == 0.0 {
        return vec![0.0; right.len()];
    }
    let mut basis = vec![right.iter().map(|value| value / size).collect::<Vec<f64>>()];
    let mut columns: Vec<Vec<f64>> = Vec::new();
    let mut turns: Vec<(f64, f64)> = Vec::new();
    let mut rest = vec![size];
    for step in 0..most {
        let mut next = Vec::new();
        product(&basis[step], &mut next);
        let mut column = Vec::with_capacity(step + 2);
        for vector in &basis {
            let along = dot(vector, &next);
            next.iter_mut().zip(vector).for_each(|(value, part)| *value -= along * part);
            column.push(along);
        }
        let length = norm(&next);
        column.push(length);
        for (row, (cosine, sine)) in turns.iter().enumerate() {
            let (upper, lower) = (column[row], column[row + 1]);
            column[row] = cosine * upper + sine * lower;
            column[row + 1] = cosine * lower - sine * upper;
        }
        let radius = column[step].hypot(column[step + 1]);
        let (cosine, sine) = (column[step] / radius, column[step + 1] / radius);
        column.truncate(step + 1);
        column[step] = radius;
        turns.push((cosine, sine));
        rest.push(-sine * rest[step]);
        rest[step] *= cosine;
        columns.push(column);
        if rest[step + 1].abs() <= tolerance * size || length == 0.0 {
            break;
        }
        basis.push(next.iter().map(|value| value / length).collect());
    }
    combined(&basis, &columns, &rest)
}

/// Combination of the basis that the triangle of columns asks for.
fn combined(basis: &[Vec<f64>], columns: &[Vec<f64>], rest: &[f64]) -> Vec<f64> {
    let mut weights = rest[..columns.len()].to_vec();
    for row in (0..columns.len()).rev() {
        let above: f64 = (row + 1..columns.len()).map(|column| columns[column][row] * weights[column]).sum();
        weights[row] = (weights[row] - above) / columns[row][row];
    }
    let mut found = vec![0.0; basis[0].len()];
    for (vector, weight) in basis.iter().zip(&weights) {
        found.iter_mut().zip(vector).for_each(|(value, part)| *value += weight * part);
    }
    found
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::solve;

    #[test]
    fn solves_a_system_that_is_not_symmetric() {
        let matrix =
            [[4.0, 1.0, 0.0, 0.5], [-1.0, 3.0, 0.2, 0.0], [0.3, 0.0, 5.0, 1.0], [0.0, -0.4, 1.0, 2.0]];
        let product = |x: &[f64], out: &mut Vec<f64>| {
            out.extend(matrix.iter().map(|row| row.iter().zip(x).map(|(a, x)| a * x).sum::<f64>()));
        };
        let wanted = [1.0, -2.0, 0.5, 3.0];
        let mut right = Vec::new();
        product(&wanted, &mut right);
        let found = solve(product, &right, 1e-14, 10);
        assert!(found.iter().zip(&wanted).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
        assert_eq!(solve(product, &[0.0; 4], 1e-14, 10), [0.0; 4]);
    }
}

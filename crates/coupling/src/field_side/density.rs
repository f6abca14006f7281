//! Density of the charges in a rank's cells.

use super::side::{FieldSide, no_mesh, no_request, of_dem};
use crate::CouplingError;
use amberfield_core::Vector3;
use amberfield_field::FieldError;
use amberfield_field::far::SmoothDensity;
use amberfield_wire::Section;
use amberfield_wire::payloads::FarQuestion;

impl FieldSide {
    /// Density [C/m³] at this rank's cell centres of the charges that were asked about. Of charges that are
    /// spread over their cells the cells are found too.
    ///
    /// # Errors
    /// Charges that are not finite.
    pub fn density(&mut self, density: &mut [f64]) -> Result<(), CouplingError> {
        let cloud = self.sections()?.one::<FarQuestion>(Section::FarQuestion).map_err(of_dem)?.cloud;
        self.check_charges()?;
        if cloud.is_nearest_cell() {
            return self.map(density);
        }
        // Clouds belong to no cell, and the DEM side knows where its grains are.
        self.cells.clear();
        (self.charge, self.outside) = (0.0, 0);
        let mesh = self.mesh.as_ref().ok_or_else(no_mesh)?;
        if self.density.as_ref().is_none_or(|(known, _)| *known != cloud) {
            let centres = mesh.centres();
            let first = centres.first().copied().unwrap_or_default();
            let low = centres.iter().fold(first, |low, centre| low.inf(centre));
            let high = centres.iter().fold(first, |high, centre| high.sup(centre));
            // The box of a rank that has all cells along an axis is the mesh's, whose period counts.
            let reach = Vector3::repeat(0.5 * mesh.largest_cell());
            let whole = mesh.domain();
            let (low, high) = ((low - reach).sup(&whole.min()), (high + reach).inf(&whole.max()));
            self.density = Some((cloud, SmoothDensity::new(whole, low, high, cloud.radius_m, cloud.shape)));
        }
        let message = self.asked.as_ref().ok_or_else(no_request)?;
        let sections = message.sections();
        let (_, smooth) = self.density.as_mut().expect("just made");
        smooth.clear();
        for (places, charges) in
            [(Section::Positions, Section::Charges), (Section::ImagePositions, Section::ImageCharges)]
        {
            let places = sections.get::<[f64; 3]>(places).map_err(of_dem)?;
            let charges = sections.exactly::<f64>(charges, places.len()).map_err(of_dem)?;
            self.positions.clear();
            self.positions.extend(places.iter().map(|&place| Vector3::from(place)));
            smooth.add(&self.positions, charges);
        }
        smooth.at(mesh.centres(), density);
        Ok(())
    }

    /// Refuses charges and places that are no numbers.
    fn check_charges(&self) -> Result<(), CouplingError> {
        for (places, charges) in
            [(Section::Positions, Section::Charges), (Section::ImagePositions, Section::ImageCharges)]
        {
            let places = self.section::<[f64; 3]>(places)?;
            let charges = self.section::<f64>(charges)?;
            let is_number = |(place, charge): (&[f64; 3], &f64)| {
                charge.is_finite() && place.iter().all(|x| x.is_finite())
            };
            if let Some(index) = places.iter().zip(charges).position(|pair| !is_number(pair)) {
                return Err(CouplingError::Mesh(FieldError::NotFinite { index }));
            }
        }
        Ok(())
    }

    /// Finds each charge's cell and adds up the cells' charge over their volumes.
    fn map(&mut self, density: &mut [f64]) -> Result<(), CouplingError> {
        let message = self.asked.as_ref().ok_or_else(no_request)?;
        let mesh = self.mesh.as_ref().ok_or_else(no_mesh)?;
        let sections = message.sections();
        let places = sections.get::<[f64; 3]>(Section::Positions).map_err(of_dem)?;
        let charges = sections.exactly::<f64>(Section::Charges, places.len()).map_err(of_dem)?;
        self.cells.resize(places.len(), u64::MAX);
        self.last_cells.resize(places.len(), u32::MAX);
        (self.charge, self.outside) = (0.0, 0);
        density.fill(0.0);
        for (index, (place, &charge)) in places.iter().zip(charges).enumerate() {
            let place = Vector3::from(*place);
            let last = (self.last_cells[index] != u32::MAX).then_some(self.last_cells[index]);
            let (cell, inside) = mesh.locate(&place, last);
            self.last_cells[index] = cell;
            // Strays belong to the nearest wall's cell; with several ranks they are the DEM side's to place.
            let mine = inside || self.ranks == 1;
            self.cells[index] = if mine { u64::from(cell) } else { u64::MAX };
            self.outside += u64::from(!inside && self.ranks == 1);
            if mine {
                self.charge += charge;
                density[cell as usize] += charge;
            }
        }
        for (density, volume) in density.iter_mut().zip(mesh.volumes()) {
            *density /= volume;
        }
        Ok(())
    }
}

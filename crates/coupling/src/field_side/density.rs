//! Density of the charges in a rank's cells.

use super::side::{FieldSide, no_mesh, no_request, of_dem};
use crate::CouplingError;
use crate::mesh::OwnCells;
use amberfield_core::Vector3;
use amberfield_field::FieldError;
use amberfield_field::far::SmoothDensity;
use amberfield_wire::Section;
use amberfield_wire::payloads::FarQuestion;

impl FieldSide {
    /// Density [C/m³] at this rank's cell centres of the charges that were asked about.
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
        let own = self.cells_of_rank.as_ref().ok_or_else(no_mesh)?;
        let OwnCells { whole, centres, .. } = own;
        if self.density.as_ref().is_none_or(|(known, _)| *known != cloud) {
            let [low, high] = own.corners();
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
        smooth.at(centres, density);
        if let Some(more) = self.of_own_cells(Section::SourceDensity)? {
            for (density, more) in density.iter_mut().zip(more) {
                *density += more;
            }
        }
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

    /// Adds up the charge of each cell of this rank over its volume; the DEM side has found the cells.
    fn map(&mut self, density: &mut [f64]) -> Result<(), CouplingError> {
        let numbers = self.own_cells();
        let message = self.asked.as_ref().ok_or_else(no_request)?;
        let own = self.cells_of_rank.as_ref().ok_or_else(no_mesh)?;
        let sections = message.sections();
        let charges = sections.get::<f64>(Section::Charges).map_err(of_dem)?;
        let cells = sections.exactly::<u64>(Section::Cells, charges.len()).map_err(of_dem)?;
        self.cells.clear();
        (self.charge, self.outside) = (0.0, 0);
        density.fill(0.0);
        for (&charge, &cell) in charges.iter().zip(cells) {
            let place = usize::try_from(cell).ok().filter(|cell| numbers.contains(cell));
            let place = place.map(|cell| cell - numbers.start);
            self.cells.push(place.map_or(u64::MAX, |place| place as u64));
            if let Some(place) = place {
                self.charge += charge;
                density[place] += charge;
            }
        }
        for (density, volume) in density.iter_mut().zip(&own.volumes) {
            *density /= volume;
        }
        Ok(())
    }
}

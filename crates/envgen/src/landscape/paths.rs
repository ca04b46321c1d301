//! Costs of travel over a raster of classes: least-cost paths and cost fields.

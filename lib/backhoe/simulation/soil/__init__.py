"""Soil that moves: the bucket digs, carries, spills, fills a truck; volume is kept throughout."""

from backhoe.simulation.soil.ground import Ground
from backhoe.simulation.soil.rocks import Rock
from backhoe.simulation.soil.soils import SANDY_LOAM, SOILS, SoilParameters, soil_of
from backhoe.simulation.soil.terrain import Terrain

__all__ = ["SANDY_LOAM", "SOILS", "Ground", "Rock", "SoilParameters", "Terrain", "soil_of"]

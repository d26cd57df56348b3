"""Soil that moves: the bucket digs, carries, spills, fills a truck; volume is kept throughout."""

from backhoe.simulation.soil.earthmoving import LOAM, SoilParameters
from backhoe.simulation.soil.ground import Ground
from backhoe.simulation.soil.terrain import Terrain

__all__ = ["LOAM", "Ground", "SoilParameters", "Terrain"]

"""Pictures of a scene by rays: a stereo pair with true depth wherever Python runs.

- `views`: a camera's picture and depth
- `chessboards`: boards in many poses
- `texture`: smooth noise of 4 to 64 cm
- `loops`: the light of a pixel, written once
- `engine`: the same, compiled
"""

from backhoe.perception.picture.chessboards import chessboard_pictures
from backhoe.perception.picture.texture import Texture, smooth_noise
from backhoe.perception.picture.views import Paint, View, looking, view

__all__ = ["Paint", "Texture", "View", "chessboard_pictures", "looking", "smooth_noise", "view"]

// models/caustic_plate for POV-Ray 3.7. The picture's values are the irradiance [W/m2] at 1 W/sr, over 400: fixed point
// ends at 1. Declare=Photons=N sets how many are wanted on surfaces, Declare=MeshBall=1 takes the ball from ball.inc.
#version 3.7;
global_settings {
  assumed_gamma 1
  max_trace_level 20
  photons { count Photons }
}

camera { location <0, .19, 0> sky z right x up y angle 92.93760142877164 look_at <0, 0, 0> }

// Inverse square: 2 / (1 + (d / f)^2) is 2 f^2 / d^2 for a tiny f. Diffuse in POV-Ray is without 1/pi.
#declare Fade = .001;
light_source { <0, 1, 0> rgb 1 / (2 * Fade * Fade) fade_distance Fade fade_power 2 }

plane {
  y, 0
  pigment { rgb 1 / 400 }
  finish { ambient 0 diffuse 1 }
}

#ifdef (MeshBall)
  #include "ball.inc"
#else
  #declare Ball = sphere { <0, .5, 0>, .3 }
#end
object {
  Ball
  pigment { rgbf 1 }
  finish { ambient 0 diffuse 0 reflection { 0, 1 fresnel on } conserve_energy }
  interior { ior 1.5 }
  photons { target reflection on refraction on }
}

// models/default_scene for POV-Ray 3.7, to measure against: the same shapes, camera, light, Fresnel glass with Bouguer
// absorption, highlight, texture and photons. Emission (Ka) is left out: it costs no ray. Declare=Photons=N sets
// how many photons are wanted on surfaces; Library_Path names the folder of grass.png.
#version 3.7;
#ifndef (Photons)
  #declare Photons = 20000;
#end

global_settings {
  assumed_gamma 1
  #if (Photons > 0)
    photons { count Photons gather 20, 50 }  // cheaper than 50, 50, and than the default of 20, 100
  #end
}

camera { location <2, 1.5, 2> right -x up y angle 53.13010235415598 look_at <0, .5, 0> }
background { rgb <.1, .3, .6> }

// Inverse square: 2 / (1 + (d / f)^2) is 2 f^2 / d^2 for a tiny f. Diffuse in POV-Ray is without 1/pi, which takes the
// pi of the light's intensity of pi W/sr.
#declare Fade = .001;
light_source { <0, 1, 0> rgb 1 / (2 * Fade * Fade) fade_distance Fade fade_power 2 }

plane {
  y, 0
  pigment { image_map { png "grass.png" gamma 1 interpolate 2 } rotate 90 * x scale 5 }
  finish { ambient 0 diffuse 1 }
}

sphere {
  <0, .5, 0>, .3
  pigment { rgbf 1 }
  finish { ambient 0 diffuse 0 phong .3 phong_size 42 reflection { 0, 1 fresnel on } conserve_energy }
  // exp(-(1 - fade_color) d / fade_distance): sigma_a is 2/3, 1/9, 3/7 per metre.
  interior { ior 1.5 fade_power 1001 fade_distance 1 fade_color <1/3, 8/9, 4/7> }
  photons { target reflection on refraction on }
}

triangle {
  <-.2, .1, .9>, <.2, .1, .9>, <-.2, .1, -.1>
  pigment { rgb <.28, .21, .14> }
  finish { ambient 0 diffuse 1 }
}

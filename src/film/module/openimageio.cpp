// replaced by the image module

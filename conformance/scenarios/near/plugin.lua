function TestCase.run()
  rtf.check_near(1.25, 1.0, 0.1, "gain")
  rtf.check_near({ 1, 2, 3.5 }, { 1, 2, 3 }, 0.1, "pose")
  rtf.check_angle_near(3.1, -3.1, 0.1, "heading")
  rtf.check_angle_near(0, 1, 0.1, "yaw")
end

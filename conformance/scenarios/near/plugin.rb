require "rtf"

class Near < RTF::TestCase
  def run
    check_near(1.25, 1.0, 0.1, "gain")
    check_near([1, 2, 3.5], [1, 2, 3], 0.1, "pose")
    check_angle_near(3.1, -3.1, 0.1, "heading")
    check_angle_near(0, 1, 0.1, "yaw")
  end
end

require "rtf"

class Picture < RTF::TestCase
  def run
    check_picture("scene", "scene.png", "stored.png", 0.01)
    check_picture("scene", "scene.png", "scene.png", 0.0)
    check_picture("scene", "scene.png", "golden/none.png", 0.01)
    report("the test continues")
  end
end

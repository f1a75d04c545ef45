require "rtf"

class FaultTest < RTF::TestCase
  def ticks
    File.read("tick").to_i
  end

  def stands?
    before = ticks
    sleep(0.15)
    ticks == before
  end

  def run
    fault("drop") do |lost|
      check(stands?, "the camera stands")
      lost.remove
    end
    before = ticks
    wait_until(30, "the camera to run") { ticks > before }
    fault("drop")
    check(stands?, "the camera stands again")
    fault("drop")
    report("not reached")
  end
end

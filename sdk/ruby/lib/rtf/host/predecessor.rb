# frozen_string_literal: true

require "robottestingframework"
require "rtf/test_case"

module RTF
  module Host
    # Calls a test that was written for robot-testing-framework 2.x as that did.
    #
    # Such a test is a class with the name `TestCase` that derives from none of
    # ours. Its functions are those of the module RobotTestingFramework.
    class Predecessor < TestCase
      CLASS_NAME = :TestCase

      class << self
        # The module's other names: the one in the predecessor's own guide, and
        # the one that it had before version 2, which is ours too.
        def lend_module
          RobotTestingFramework.singleton_methods(false).each do |name|
            RTF.define_singleton_method(name) do |*arguments|
              RobotTestingFramework.public_send(name, *arguments)
            end
          end
          Object.class_eval { private def robottestingframework = RobotTestingFramework }
        end

        # The file's own class `TestCase`, unless it is one of ours.
        def find(file)
          return unless Object.const_defined?(CLASS_NAME, false)

          found = Object.const_get(CLASS_NAME, false)
          place, = Object.const_source_location(CLASS_NAME, false)
          found if place == file && found.is_a?(Class) && !(found <= Plugin)
        end
      end

      # Takes the object that the plug-in's class made.
      def initialize(test)
        super()
        @test = test
      end

      # Hands over the parameters in one piece; only what is true is a success.
      def setup(_args)
        return true unless @test.respond_to?(:setup)

        session = Session.current
        done = @test.setup(session.task.param)
        if done.nil? && session.judge.first.nil?
          session.error("setup returned nothing, it has to return true")
        end
        done || false
      end

      def run
        @test.run
      end

      def tear_down
        @test.tearDown if @test.respond_to?(:tearDown)
      end
    end
  end
end

# frozen_string_literal: true

require "robottestingframework"
require "rtf/test_case"

module RTF
  module Host
    # Runs a test that was written for robot-testing-framework 2.x.
    #
    # Such a test is a class named `TestCase` that derives from no class of the SDK. It calls
    # the functions of the module RobotTestingFramework.
    class Predecessor < TestCase
      CLASS_NAME = :TestCase

      class << self
        # Adds the module's other names: the one in the predecessor's guide, and the one
        # before version 2, which is also the SDK's.
        def add_module
          RobotTestingFramework.singleton_methods(false).each do |name|
            RTF.define_singleton_method(name) do |*arguments|
              RobotTestingFramework.public_send(name, *arguments)
            end
          end
          Object.class_eval { private def robottestingframework = RobotTestingFramework }
        end

        # The file's class `TestCase`, unless it derives from a class of the SDK.
        def find(file)
          return unless Object.const_defined?(CLASS_NAME, false)

          found = Object.const_get(CLASS_NAME, false)
          place, = Object.const_source_location(CLASS_NAME, false)
          found if place == file && found.is_a?(Class) && !(found <= Plugin)
        end
      end

      # Wraps an object of the plug-in's class.
      def initialize(test)
        super()
        @test = test
      end

      # Passes the parameters as one string; only a true result is a success.
      def setup(_args)
        return true unless @test.respond_to?(:setup)

        session = Session.current
        done = @test.setup(session.task.param)
        if done.nil? && session.request.passed?
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

--  SPDX-License-Identifier: Apache-2.0
--  The binary interface of plug-ins, version 1: what sdk/c/include/rtf/plugin.h
--  says to C. Fields are only ever appended.

with Interfaces.C;
with System;

private package RobotTestingFramework.ABI is

   use type Interfaces.C.size_t;

   subtype Address is System.Address;

   Major : constant := 1;
   Minor : constant := 4;

   Kind_Test    : constant := 1;
   Kind_Fixture : constant := 2;

   Done    : constant := 0;
   Refused : constant := 1;
   Stopped : constant := 2;

   Value_Text : constant := 0;
   Value_JSON : constant := 1;

   Fault_Inject : constant := 0;
   Fault_Remove : constant := 1;

   type Message_Kind is (Report, Check, Failure, Error) with Convention => C;

   type Text is record
      Data   : Address              := System.Null_Address;
      Length : Interfaces.C.size_t  := 0;
   end record with Convention => C_Pass_By_Copy;

   type Comparison is record
      Size           : Interfaces.C.size_t;
      Expected       : Address;
      Expected_Count : Interfaces.C.size_t;
      Got            : Address;
      Got_Count      : Interfaces.C.size_t;
      Tolerance      : Interfaces.C.double;
      Worst          : Interfaces.Integer_64;
   end record with Convention => C;

   type Message is record
      Size       : Interfaces.C.size_t;
      Kind       : Interfaces.Integer_32;
      Critical   : Interfaces.Integer_32;
      Content      : Text;
      File       : Address;
      Line       : Interfaces.Unsigned_32;
      Comparison : Address;
   end record with Convention => C;

   type Measurement is record
      Size  : Interfaces.C.size_t;
      Name  : Text;
      Value : Interfaces.C.double;
      Unit  : Text;
      Low   : Address;
      High  : Address;
      File  : Address;
      Line  : Interfaces.Unsigned_32;
   end record with Convention => C;

   type Sample is record
      Size  : Interfaces.C.size_t;
      Name  : Text;
      Value : Interfaces.C.double;
      Unit  : Text;
      Low   : Address;
      High  : Address;
      Time  : Address;
      File  : Address;
      Line  : Interfaces.Unsigned_32;
   end record with Convention => C;

   type Monitor is record
      Size     : Interfaces.C.size_t;
      Formula  : Text;
      Name     : Text;
      Severity : Text;
      File     : Address;
      Line     : Interfaces.Unsigned_32;
   end record with Convention => C;

   type Parameter is record
      Name  : Text;
      Value : Text;
   end record with Convention => C;

   type Test_Case is record
      Size            : Interfaces.C.size_t;
      Name            : Text;
      Parameters      : Address;
      Parameter_Count : Interfaces.C.size_t;
      File            : Address;
      Line            : Interfaces.Unsigned_32;
   end record with Convention => C;

   type Attachment is record
      Size       : Interfaces.C.size_t;
      Path       : Text;
      Name       : Text;
      Media_Type : Text;
   end record with Convention => C;

   type Question is record
      Size           : Interfaces.C.size_t;
      Content        : Text;
      Choices        : Address;
      Choice_Count   : Interfaces.C.size_t;
      Default_Answer : Text;
      Timeout        : Interfaces.C.double;
      Picture        : Text;
      File           : Address;
      Line           : Interfaces.Unsigned_32;
   end record with Convention => C;

   type Test is record
      Size       : Interfaces.C.size_t;
      Id         : Interfaces.Unsigned_32;
      Repetition : Interfaces.Unsigned_32;
      Attempt    : Interfaces.Unsigned_32;
      Reserved   : Interfaces.Unsigned_32;
      Name       : Text;
      Verdict    : Text;
      Reason     : Text;
   end record with Convention => C;

   type Trajectory is record
      Size      : Interfaces.C.size_t;
      Name      : Text;
      Reference : Text;
      Tolerance : Interfaces.C.double;
      Band      : Address;
      File      : Address;
      Line      : Interfaces.Unsigned_32;
      Align     : Interfaces.Integer_32;
   end record with Convention => C;

   type Picture is record
      Size      : Interfaces.C.size_t;
      Name      : Text;
      Picture   : Text;
      Reference : Text;
      Tolerance : Interfaces.C.double;
      File      : Address;
      Line      : Interfaces.Unsigned_32;
   end record with Convention => C;

   type Take_Message is access procedure (Context : Address; Value : Message)
     with Convention => C;
   type Take_Measurement is access function
     (Context : Address; Value : Measurement) return Interfaces.C.int
     with Convention => C;
   type Take_Sample is access function
     (Context : Address; Value : Sample) return Interfaces.C.int
     with Convention => C;
   type Take_Trajectory is access procedure (Context : Address; Value : Trajectory)
     with Convention => C;
   type Take_Attachment is access procedure (Context : Address; Value : Attachment)
     with Convention => C;
   type Take_Text is access procedure (Context : Address; Value : Text)
     with Convention => C;
   type Tell_Flag is access function (Context : Address) return Interfaces.C.int
     with Convention => C;
   type Wait_For is access function
     (Context : Address; Seconds : Interfaces.C.double) return Interfaces.C.int
     with Convention => C;
   type Tell_Text is access function (Context : Address) return Text
     with Convention => C;
   type Tell_Number is access function (Context : Address) return Interfaces.Unsigned_32
     with Convention => C;

   type Begin_Case is access function
     (Context : Address; Value : Test_Case) return Interfaces.C.int
     with Convention => C;
   type End_Case is access procedure (Context : Address; Result : Interfaces.Integer_32)
     with Convention => C;
   type Take_Texts is access procedure
     (Context : Address; Texts : Address; Count : Interfaces.C.size_t)
     with Convention => C;
   type Tell_Parameters is access function
     (Context : Address; Count : not null access Interfaces.C.size_t) return Address
     with Convention => C;

   type Take_Value is access procedure
     (Context : Address; Name : Text; Kind : Interfaces.Integer_32; Value : Text)
     with Convention => C;

   type Ask_Question is access function
     (Context : Address; Value : Question; Answer : not null access Text)
      return Interfaces.Integer_32
     with Convention => C;

   type Take_Monitor is access procedure (Context : Address; Value : Monitor)
     with Convention => C;

   type Request_Fault is access function
     (Context : Address;
      Action  : Interfaces.Integer_32;
      Name    : Text;
      File    : Address;
      Line    : Interfaces.Unsigned_32) return Interfaces.Integer_32
     with Convention => C;

   type Take_Picture is access procedure (Context : Address; Value : Picture)
     with Convention => C;

   type Host_Table is record
      Major       : Interfaces.Unsigned_32;
      Minor       : Interfaces.Unsigned_32;
      Size        : Interfaces.C.size_t;
      Context     : Address;
      Message     : Take_Message;
      Measure     : Take_Measurement;
      Attach      : Take_Attachment;
      Collapsed   : Take_Text;
      Interrupted : Tell_Flag;
      Wait        : Wait_For;
      Name        : Tell_Text;
      Param       : Tell_Text;
      Environment : Tell_Text;
      Repetition  : Tell_Number;
      Sample      : Take_Sample;
      Case_Begin  : Begin_Case;
      Case_End    : End_Case;
      Plan_Cases  : Take_Texts;
      Skip        : Take_Text;
      Parameters  : Tell_Parameters;
      Provide     : Take_Value;
      Values      : Tell_Parameters;
      Ask         : Ask_Question;
      Trajectory  : Take_Trajectory;
      Monitor     : Take_Monitor;
      Fault       : Request_Fault;
      Picture     : Take_Picture;
   end record with Convention => C;

   type Host_Access is access constant Host_Table with Convention => C;

   type Make_Plugin is access function (Host : Host_Access) return Address
     with Convention => C;
   type End_Plugin is access procedure (Self : Address) with Convention => C;
   type Set_Up_Plugin is access function
     (Self : Address; Count : Interfaces.C.int; Arguments : Address)
      return Interfaces.Integer_32
     with Convention => C;
   type Step is access function (Self : Address) return Interfaces.Integer_32
     with Convention => C;
   type Notice is access function
     (Self : Address; Test : not null access constant ABI.Test) return Interfaces.Integer_32
     with Convention => C;

   type Plugin_Table is record
      Major     : Interfaces.Unsigned_32 := ABI.Major;
      Minor     : Interfaces.Unsigned_32 := ABI.Minor;
      Size      : Interfaces.C.size_t    := 0;
      Kind      : Interfaces.Integer_32  := Kind_Test;
      Name      : Address                := System.Null_Address;
      Create    : Make_Plugin;
      Destroy   : End_Plugin;
      Set_Up    : Set_Up_Plugin;
      Run       : Step;
      Check     : Step;
      Tear_Down : Step;
      Started   : Notice;
      Finished  : Notice;
   end record with Convention => C;

end RobotTestingFramework.ABI;
